!> The language of the data file as one constant table: the groups, their names, and the values that each name takes.
!> Reader, help, documentation and conversation are all made from it.
!>
!> Each field of a row is longer than its longest text, since longer ones would be cut without a warning; a test looks at all rows.
module mech9_grammar
  use mech9_program_kind, only: kinematics, dynamics, both => both_programs
  use mech9_text, only: lower
  use mech9_grammar_rows, only: group_row_type, item_row_type, unlimited, for_forces, needed, optional, any_law, &
    variable_of_law
  use mech9_study_grammar, only: study_items, link_items, long_term_items
  use mech9_output_grammar, only: output_items
  implicit none
  private
  public :: group_row_type, item_row_type, group_table, item_table, unlimited, for_forces
  public :: find_group_row, row_of_group, rows_of_group, words_of, names_of_groups, names_in_group

  character(len=*), parameter :: screws = 'revolute prismatic helical'
  character(len=*), parameter :: joints = 'spherical universal cylindrical planar free'
  character(len=*), parameter :: motion_laws = 'dwell constant-velocity harmonic cycloidal polynomial345 polynomial4567 '// &
                                               'modified-sine modified-trapezoidal'

  type(group_row_type), parameter :: group_table(*) = [ &
    group_row_type('mechanism', .false., '', both, 'title, numbers of links and coordinates, units'), &
    group_row_type('structure', .false., '', both, &
                   'which links meet, which coordinates are independent: first set (c, cq) or second (nrg, nws, rdw, nrw)'), &
    group_row_type('pair', .true., 'coordinate', both, &
                   'a joint of two links: its kind, its coordinate or coordinates, its point and axis'), &
    group_row_type('link', .true., 'number', both, 'the name of a link, which may stand for its number'), &
    group_row_type('initial', .true., 'coordinate', both, &
                   'a coordinate at the start: a guess of a dependent one, the value of an independent one'), &
    group_row_type('coupling', .true., '', both, &
                   'an equation between coordinates, as of gears, racks, belts and screws'), &
    group_row_type('point', .true., 'name', both, 'a point of a link whose motion is recorded'), &
    group_row_type('drive', .true., 'coordinate', both, &
                   'an independent coordinate as a function of time; mech9k needs one for each, in mech9d the others are free'), &
    group_row_type('body', .true., 'link', for_forces, 'mass, centre and inertia of a link; links without a body are massless'), &
    group_row_type('gravity', .false., '', for_forces, 'the acceleration of gravity'), &
    group_row_type('load', .true., '', for_forces, 'a force, torque, spring or damper, or a user''s procedure'), &
    group_row_type('motor', .true., '', dynamics, &
                   'a motor on an independent coordinate without a drive: direct current, or set by a PID controller'), &
    group_row_type('stop', .true., '', both, &
                   'one or two ends of the range of a coordinate, independent or not: rigid, with impacts, or compliant'), &
    group_row_type('friction', .true., '', for_forces, &
                   'dry friction in a turning, sliding or helical pair, by the force that the pair passes on'), &
    group_row_type('contact', .true., '', both, &
                   'a ball about a traced point, or the point, that may touch a plane, a sphere or a path of another link'), &
    group_row_type('cam', .true., '', kinematics, &
                   'a cam whose profile mech9k computes from the motion of its follower (option --cam)'), &
    group_row_type('parameter', .true., 'name', both, &
                   'a number by name that sets numbers of this file, for studies, sensitivities and optimisation'), &
    group_row_type('quantity', .true., 'name', both, &
                   'a number from a whole run: an extreme, a mean or an integral of a column of the results'), &
    group_row_type('study', .false., '', both, &
                   'the sets of parameter values for which --study makes runs'), &
    group_row_type('objective', .true., '', both, &
                   'a path, a function, poses or a quantity that the mechanism should have, for --optimize'), &
    group_row_type('limit', .true., '', both, &
                   'a condition that the designs of --optimize must meet'), &
    group_row_type('optimum', .false., '', both, &
                   'the search of --optimize for the values of the parameters that meet the objectives best'), &
    group_row_type('section', .false., '', both, 'points of the motion at values of a coordinate or a column, or after periods'), &
    group_row_type('exponents', .false., '', dynamics, 'the times over which the option --exponents takes Lyapunov exponents'), &
    group_row_type('periodic', .false., '', dynamics, 'the search of the option --periodic for periodic motions'), &
    group_row_type('branch', .true., '', both, 'positions of rest over a parameter, for the option --branch'), &
    group_row_type('time', .false., '', both, &
                   'the times of the results: start + (end - start) i/intervals, i = 0 .. intervals'), &
    group_row_type('solver', .false., '', dynamics, 'method and tolerances of the integration'), &
    group_row_type('output', .false., '', both, 'the recorded quantities, and the files for them'), &
    group_row_type('user', .false., '', both, 'numbers handed to the user''s own procedures')]

  type(item_row_type), parameter :: general_items(*) = [ &
    item_row_type('mechanism', 'title', 'text', 1, 1, '', optional, '''''', '', '', '', &
                  'one line that describes the mechanism', '''Four-bar'''), &
    item_row_type('mechanism', 'links', 'integer', 1, 1, '', optional, '(counted)', '>=1', '', '', &
                  'number of links, the frame included, which is link 1', '6'), &
    item_row_type('mechanism', 'coordinates', 'integer', 1, 1, '', optional, '(counted)', '>=1', '', '', &
                  'number of coordinates: a pair has as many as it has freedoms', '7'), &
    item_row_type('mechanism', 'angle_unit', 'text', 1, 1, '', optional, '''rad''', '', 'rad deg', '', &
                  'unit of all angles in this file and in its results', '''deg'''), &
    item_row_type('mechanism', 'length_unit', 'text', 1, 1, '', optional, '''m''', '', 'm mm in', '', &
                  'unit of all lengths in this file and in its results, where these tables have m', '''mm''', seldom=.true.), &
    item_row_type('mechanism', 'force_unit', 'text', 1, 1, '', optional, '''N''', '', 'N kN lbf', '', &
                  'unit of all forces, where these tables have N; torques and energies are force times length', '''kN''', &
                  seldom=.true.), &
    item_row_type('mechanism', 'mass_unit', 'text', 1, 1, '', optional, '''kg''', '', 'kg g t lb', '', &
                  'unit of all masses, where these tables have kg; moments of inertia are mass times length^2', '''t''', &
                  seldom=.true.), &
    item_row_type('mechanism', 'rate_unit', 'text', 1, 1, '', optional, '(angle_unit/s)', '', 'rad/s deg/s rpm', '', &
                  'unit of the rates of angles: velocity, angular_frequency, second coefficient of a drive, columns dq', &
                  '''rpm''', seldom=.true.), &
    item_row_type('mechanism', 'data_tolerance', 'real', 1, 1, '', optional, '0', '>=0', '', '', &
                  'error of the dimensions (over the mechanism''s size) and of the angles (rad): limit of residuals '// &
                  'of redundant equations', '1e-6', seldom=.true.), &
    item_row_type('structure', 'c', 'integer', 1, unlimited, '', optional, '(from the pairs)', '>=0', '', '', &
                  'coincidence matrix by rows: element i,j is the number of the pair between links i and j, or 0', &
                  'c(1,:) = 0, 1, 2'), &
    item_row_type('structure', 'cq', 'integer', 1, unlimited, '', optional, '(from rdw)', '>=1', '', '', &
                  'numbers of the independent coordinates', '5'), &
    item_row_type('structure', 'nrg', 'integer', 1, unlimited, '', optional, '(from c and cq)', '>=1', '', '', &
                  'second set: links in the order of computation', '1, 2, 3, 1'), &
    item_row_type('structure', 'nws', 'integer', 1, unlimited, '', optional, '(from c and cq)', '>=0', '', '', &
                  'second set: the coordinate that leads to each link of nrg; 0 where a chain starts', '0, 1, 2, 3'), &
    item_row_type('structure', 'rdw', 'integer', 1, unlimited, '', optional, '(from c and cq)', '>=0', '', '', &
                  'second set: 1 where the coordinate in nws is independent or a chain starts, else 0', '1, 1, 0, 0'), &
    item_row_type('structure', 'nrw', 'integer', 1, unlimited, '', optional, '(from c and cq)', '>=0', '', '', &
                  'second set: number of chains that are closed up to each link of nrg', '0, 0, 0, 1')]

  type(item_row_type), parameter :: pair_items(*) = [ &
    item_row_type('pair', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', screws//' path user', &
                  'number of its coordinate', '5'), &
    item_row_type('pair', 'coordinates', 'integer', 3, 3, '', needed, '', '>=1', '', 'spherical', &
                  'numbers of its three coordinates: turns about x, then y, then z of the joint''s frame', '4, 5, 6'), &
    item_row_type('pair', 'coordinates', 'integer', 2, 2, '', needed, '', '>=1', '', 'universal', &
                  'numbers of its two coordinates: the turn about axis, then that about moving_axis', '4, 5'), &
    item_row_type('pair', 'coordinates', 'integer', 2, 2, '', needed, '', '>=1', '', 'cylindrical', &
                  'numbers of its two coordinates: the turn about the axis and the slide along it', '4, 5'), &
    item_row_type('pair', 'coordinates', 'integer', 3, 3, '', needed, '', '>=1', '', 'planar', &
                  'numbers of its three coordinates: slides along zero and across it in the plane, and the turn', '4, 5, 6'), &
    item_row_type('pair', 'coordinates', 'integer', 6, 6, '', needed, '', '>=1', '', 'free', &
                  'numbers of its six coordinates: slides along x, y, z of the joint''s frame, then turns about x, y, z', &
                  '4, 5, 6, 7, 8, 9'), &
    item_row_type('pair', 'links', 'integer', 2, 2, '', needed, '', '>=1', '', '', &
                  'the reference link and the moving link', '1, 2'), &
    item_row_type('pair', 'kind', 'text', 1, 1, '', needed, '', '', screws//' path user '//joints, '', &
                  'it turns, slides, turns as a screw, follows a curve, moves by a user''s procedure, or has several freedoms', &
                  '''revolute'''), &
    item_row_type('pair', 'point', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', screws, &
                  'a point of the axis, in the reference link', '0, 0, 0'), &
    item_row_type('pair', 'axis', 'real', 3, 3, '', optional, '(needed unless dh)', '', '', screws, &
                  'direction of the axis, in the reference link; of any length', '0, 0, 1'), &
    item_row_type('pair', 'zero', 'real', 3, 3, '', optional, '(x, y or z axis)', '', '', screws, &
                  'direction from which q is counted, in the reference link; by default the first axis at 45 degrees or more', &
                  '1, 0, 0', seldom=.true.), &
    item_row_type('pair', 'moving_point', 'real', 3, 3, 'm', optional, '(as point)', '', '', screws, &
                  'the same point in the moving link', '-1.2, 0, 0', seldom=.true.), &
    item_row_type('pair', 'moving_axis', 'real', 3, 3, '', optional, '(as axis)', '', '', screws, &
                  'the same axis in the moving link', '0, 0, 1', seldom=.true.), &
    item_row_type('pair', 'moving_zero', 'real', 3, 3, '', optional, '(as zero)', '', '', screws, &
                  'direction in the moving link that stands at zero when q = 0', '1, 0, 0', seldom=.true.), &
    item_row_type('pair', 'point', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', joints, &
                  'the centre of the joint, or a point of its axis or plane, in the reference link', '0, 0, 0'), &
    item_row_type('pair', 'axis', 'real', 3, 3, '', needed, '', '', '', 'universal cylindrical planar', &
                  'direction of the axis, or at right angles to the plane, in the reference link; of any length', '0, 0, 1'), &
    item_row_type('pair', 'axis', 'real', 3, 3, '', optional, '0, 0, 1', '', '', 'spherical free', &
                  'z axis of the joint''s frame, in the reference link; of any length', '0, 0, 1', seldom=.true.), &
    item_row_type('pair', 'zero', 'real', 3, 3, '', optional, '(x, y or z axis)', '', '', 'spherical cylindrical planar free', &
                  'x axis of the joint''s frame, in the reference link; by default the first axis at 45 degrees or more to axis', &
                  '1, 0, 0', seldom=.true.), &
    item_row_type('pair', 'moving_point', 'real', 3, 3, 'm', optional, '(as point)', '', '', joints, &
                  'the same point in the moving link', '-1.2, 0, 0', seldom=.true.), &
    item_row_type('pair', 'moving_axis', 'real', 3, 3, '', needed, '', '', '', 'universal', &
                  'direction of the second axis, in the moving link; at q = 0 the systems of both links are parallel', '0, 1, 0'), &
    item_row_type('pair', 'moving_axis', 'real', 3, 3, '', optional, '(as axis)', '', '', 'spherical cylindrical planar free', &
                  'z axis of the joint''s frame, in the moving link', '0, 0, 1', seldom=.true.), &
    item_row_type('pair', 'moving_zero', 'real', 3, 3, '', optional, '(as zero)', '', '', 'spherical cylindrical planar free', &
                  'x axis of the joint''s frame, in the moving link', '1, 0, 0', seldom=.true.), &
    item_row_type('pair', 'name', 'text', 1, 1, '', optional, '(none)', '', '', '', &
                  'its name, which may stand for the number of its coordinate; letters, digits and _', '''B''', seldom=.true.), &
    item_row_type('pair', 'pitch', 'real', 1, 1, 'm', needed, '', '', '', 'helical', &
                  'advance per turn', '0.005'), &
    item_row_type('pair', 'dh', 'real', 4, 4, 'm, angle', optional, '(point, axis, ...)', '', '', screws, &
                  'Denavit-Hartenberg a, alpha, d, theta instead of point, axis and so on; q adds to theta or d', &
                  '0.3, 1.57, 0, 0', seldom=.true.), &
    item_row_type('pair', 'file', 'text', 1, 1, 'm', needed, '', '', '', 'path', &
                  'a text file with x, y and in space z in each line, beside the data file; a smooth curve joins the points', &
                  '''curve.dat'''), &
    item_row_type('pair', 'columns', 'integer', 2, 3, '', optional, '(all)', '>=1', '', 'path', &
                  'the columns of x, y and in space z in a file that has others too, as a table of results has', '3, 4, 5', &
                  seldom=.true.), &
    item_row_type('pair', 'scale', 'real', 1, 1, '', optional, '1', '>0', '', 'path', &
                  'the coordinates in the file are multiplied by this number', '0.001', seldom=.true.), &
    item_row_type('pair', 'orientation', 'text', 1, 1, '', optional, '''fixed''', '', 'fixed tangent', 'path', &
                  'fixed: the moving link keeps its orientation; tangent: it turns with the tangent of the curve', '''tangent'''), &
    item_row_type('pair', 'closed', 'logical', 1, 1, '', optional, '(where ends meet)', '', '', 'path', &
                  'the curve has no ends and repeats; by default where the last point of its file is the first one again', &
                  '.true.', seldom=.true.), &
    item_row_type('pair', 'point', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', 'path', &
                  'origin of the coordinates in the file, in the reference link', '0, 0.2, 0', seldom=.true.), &
    item_row_type('pair', 'axis', 'real', 3, 3, '', optional, '0, 0, 1', '', '', 'path', &
                  'z axis of the coordinates in the file, in the reference link; of any length', '0, 1, 0', seldom=.true.), &
    item_row_type('pair', 'zero', 'real', 3, 3, '', optional, '(x, y or z axis)', '', '', 'path', &
                  'x axis of the coordinates in the file; by default the first axis at 45 degrees or more to axis', &
                  '1, 0, 0', seldom=.true.), &
    item_row_type('pair', 'moving_point', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', 'path', &
                  'the point of the moving link that follows the curve', '0.1, 0, 0', seldom=.true.), &
    item_row_type('pair', 'moving_axis', 'real', 3, 3, '', optional, '0, 0, 1', '', '', 'path', &
                  'direction in the moving link along axis, or across the tangent', '0, 0, 1', seldom=.true.), &
    item_row_type('pair', 'moving_zero', 'real', 3, 3, '', optional, '(x, y or z axis)', '', '', 'path', &
                  'direction in the moving link along zero, or along the tangent', '1, 0, 0', seldom=.true.)]

  type(item_row_type), parameter :: coupling_items(*) = [ &
    item_row_type('coupling', 'kind', 'text', 1, 1, '', needed, '', '', 'gear rack belt screw linear table user', '', &
                  'which machine part couples them; linear: a sum; table: a function from a file; user: the user''s procedure', &
                  '''gear'''), &
    item_row_type('coupling', 'coordinates', 'integer', 2, unlimited, '', needed, '', '>=1', '', '', &
                  'numbers of the coordinates: two, of which the first moves the second, or any for linear', '2, 5'), &
    item_row_type('coupling', 'ratio', 'real', 1, 1, '', needed, '', '', '', 'gear', &
                  'change of the second coordinate per change of the first one; negative: the other way', '-2.5'), &
    item_row_type('coupling', 'radius', 'real', 1, 1, 'm', needed, '', '', '', 'rack', &
                  'slide of the second coordinate per rad of the first one; negative: the other way', '0.02'), &
    item_row_type('coupling', 'radii', 'real', 2, 2, 'm', needed, '', '>0', '', 'belt', &
                  'radii of the pulleys of both coordinates', '0.05, 0.1'), &
    item_row_type('coupling', 'crossed', 'logical', 1, 1, '', optional, '.false.', '', '', 'belt', &
                  'whether the belt is crossed, so that the pulleys turn in opposite directions', '.true.', seldom=.true.), &
    item_row_type('coupling', 'pitch', 'real', 1, 1, 'm', needed, '', '', '', 'screw', &
                  'slide of the second coordinate per turn of the first one; negative: a left-hand thread', '0.005'), &
    item_row_type('coupling', 'phase', 'real', 1, 1, 'q', optional, '(from &initial)', '', '', 'gear rack belt screw', &
                  'the second coordinate where the first one is zero; by default from the positions in &initial', '0', &
                  seldom=.true.), &
    item_row_type('coupling', 'file', 'text', 1, 1, '', needed, '', '', '', 'table', &
                  'a text file with both coordinates in each line; over a full turn of the first one it repeats', &
                  '''cam.dat'''), &
    item_row_type('coupling', 'coefficients', 'real', 2, unlimited, '1 per q', needed, '', '', '', 'linear', &
                  'coefficients of the coordinates in the sum, for the units of this file', '1, -2, 1'), &
    item_row_type('coupling', 'constant', 'real', 1, 1, '', optional, '0', '', '', 'linear', &
                  'the value of the sum', '0')]

  type(item_row_type), parameter :: motion_items(*) = [ &
    item_row_type('initial', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the coordinate', '4'), &
    item_row_type('initial', 'position', 'real', 1, 1, 'q', optional, '0', '', '', '', &
                  'its value, or a guess of it; a coordinate that is free in mech9d needs one', '0.2'), &
    item_row_type('initial', 'velocity', 'real', 1, 1, 'q/s', optional, '0', '', '', '', &
                  'its rate (independent coordinates in mech9d)', '1.5', program=dynamics), &
    item_row_type('point', 'name', 'text', 1, 1, '', needed, '', '', '', '', &
                  'heading of its columns in the table; letters, digits and _', '''P'''), &
    item_row_type('point', 'link', 'integer', 1, 1, '', needed, '', '>=1', '', '', 'the link it is part of', '3'), &
    item_row_type('point', 'position', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', '', &
                  'its position in the frame of the link', '1.0, 0.3, 0'), &
    item_row_type('drive', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the independent coordinate', '5'), &
    item_row_type('drive', 'kind', 'text', 1, 1, '', needed, '', '', 'polynomial harmonic table segments user', '', &
                  'the form of the function', '''polynomial'''), &
    item_row_type('drive', 'coefficients', 'real', 1, unlimited, 'q, q/s, ...', needed, '', '', '', 'polynomial', &
                  'c0, c1, c2, ... of q = c0 + c1 t + c2 t^2 + ...', '0.5, 2.0'), &
    item_row_type('drive', 'mean', 'real', 1, 1, 'q', optional, '0', '', '', 'harmonic', &
                  'the mean in q = mean + amplitude sin(angular_frequency t + phase)', '0.1'), &
    item_row_type('drive', 'amplitude', 'real', 1, 1, 'q', needed, '', '', '', 'harmonic', &
                  'largest distance of the coordinate from the mean', '0.3'), &
    item_row_type('drive', 'angular_frequency', 'real', 1, 1, 'angle/s', needed, '', '', '', 'harmonic', &
                  'growth of the angle of the sine per second; the period is a full turn divided by it', '6.28'), &
    item_row_type('drive', 'phase', 'real', 1, 1, 'angle', optional, '0', '', '', 'harmonic', &
                  'angle of the sine at t = 0; 0 starts at the mean, with q increasing where the amplitude is positive', '1.57'), &
    item_row_type('drive', 'file', 'text', 1, 1, 's, q', needed, '', '', '', 'table', &
                  'a text file with t and q in each line, in the folder of the data file; a smooth curve joins the points', &
                  '''motion.dat'''), &
    item_row_type('drive', 'times', 'real', 2, unlimited, 's', needed, '', '', '', 'segments', &
                  'the times at which segments begin and end, increasing', '0, 0.5, 1'), &
    item_row_type('drive', 'values', 'real', 2, unlimited, 'q', needed, '', '', '', 'segments', &
                  'the coordinate at these times', '0, 0.02, 0.02'), &
    item_row_type('drive', 'laws', 'text', 1, unlimited, '', needed, '', '', motion_laws, 'segments', &
                  'the motion law of each segment, or one for all', '''cycloidal'''), &
    item_row_type('drive', 'period', 'real', 1, 1, 's', optional, '(no repetition)', '>0', '', 'segments', &
                  'the segments repeat after this time, which is that from the first to the last of times', '1')]

  type(item_row_type), parameter :: body_items(*) = [ &
    item_row_type('body', 'link', 'integer', 1, 1, '', needed, '', '>=1', '', '', 'the link it belongs to', '3'), &
    item_row_type('body', 'mass', 'real', 1, 1, 'kg', needed, '', '>=0', '', '', 'its mass', '2.0'), &
    item_row_type('body', 'centre', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', '', &
                  'its mass centre, in the frame of the link', '1.6, 0.4, 0'), &
    item_row_type('body', 'inertia', 'real', 6, 6, 'kg m^2', optional, '0, 0, 0, 0, 0, 0', '', '', '', &
                  'xx, yy, zz, xy, xz, yz about the centre, in link axes; xy is minus the integral of xy dm; '// &
                  'one is enough in a plane', &
                  '0.1, 0.1, 0.2, 0, 0, 0'), &
    item_row_type('gravity', 'acceleration', 'real', 3, 3, 'm/s^2', needed, '', '', '', '', &
                  'its components along the axes of link 1', '0, -9.81, 0')]

  type(item_row_type), parameter :: load_items(*) = [ &
    item_row_type('load', 'kind', 'text', 1, 1, '', needed, '', '', 'force torque spring coordinate user', '', &
                  'force or torque on a link, spring between two points, load on a coordinate, or a user''s procedure', &
                  '''force'''), &
    item_row_type('load', 'link', 'integer', 1, 1, '', needed, '', '>=1', '', 'force torque', 'the link it acts on', '5'), &
    item_row_type('load', 'links', 'integer', 2, 2, '', needed, '', '>=1', '', 'spring', 'the two links it joins', '1, 5'), &
    item_row_type('load', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', 'coordinate', &
                  'number of the coordinate it acts on', '6'), &
    item_row_type('load', 'position', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', 'force spring', &
                  'the point at which it acts on the (first) link, in the frame of the link', '1.0, 0, 0'), &
    item_row_type('load', 'second_position', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', 'spring', &
                  'the point at which it acts on the second link, in the frame of the link', '0, 0.3, 0'), &
    item_row_type('load', 'force', 'real', 3, 3, 'N', needed, '', '', '', 'force', &
                  'its components along the axes chosen by frame', '0, -10, 0'), &
    item_row_type('load', 'force', 'real', 1, 1, 'N or N m', optional, '0', '', '', 'coordinate', &
                  'a constant part of the load', '2.5'), &
    item_row_type('load', 'torque', 'real', 3, 3, 'N m', needed, '', '', '', 'torque', &
                  'its components along the axes chosen by frame', '0, 0, 4'), &
    item_row_type('load', 'frame', 'text', 1, 1, '', optional, '''fixed''', '', 'fixed link', 'force torque', &
                  'fixed: components along the axes of link 1; link: along the axes of the link, which turn with it', '''link'''), &
    item_row_type('load', 'stiffness', 'real', 1, 1, 'N/m', optional, '0', '>=0', '', 'spring', &
                  'force per length by which it is stretched', '200'), &
    item_row_type('load', 'stiffness', 'real', 1, 1, 'N/m, N m/rad', optional, '0', '', '', 'coordinate', &
                  'the load is -stiffness (q - rest) - damping dq/dt + force; per rad for angles, also with angle_unit=''deg''', &
                  '200'), &
    item_row_type('load', 'free_length', 'real', 1, 1, 'm', optional, '0', '>=0', '', 'spring', &
                  'length at which its force is zero', '0.5'), &
    item_row_type('load', 'rest', 'real', 1, 1, 'q', optional, '0', '', '', 'coordinate', &
                  'value at which the spring is at rest', '0.5'), &
    item_row_type('load', 'damping', 'real', 1, 1, 'N s/m', optional, '0', '>=0', '', 'spring', &
                  'force per rate of its length', '1.5'), &
    item_row_type('load', 'damping', 'real', 1, 1, 'N s/m, N m s', optional, '0', '', '', 'coordinate', &
                  'torque or force per dq/dt; per rad/s for angles, also with angle_unit=''deg''', '1.5'), &
    item_row_type('load', 'law', 'text', 1, 1, '', optional, '''constant''', '', 'constant polynomial harmonic table segments', &
                  'force torque spring coordinate', 'the load is multiplied by this law of time, or of another variable, '// &
                  'with the names of &drive', '''harmonic''', seldom=.true.), &
    item_row_type('load', 'over', 'text', 1, 1, '', optional, '''t''', '', '', any_law, variable_of_law, '''q1'''), &
    item_row_type('load', 'coefficients', 'real', 1, unlimited, '1, 1/s, ...', needed, '', '', '', 'law:polynomial', &
                  'c0, c1, c2, ... of the factor c0 + c1 t + c2 t^2 + ...', '0, 0.5'), &
    item_row_type('load', 'mean', 'real', 1, 1, '', optional, '0', '', '', 'law:harmonic', &
                  'the mean in the factor mean + amplitude sin(angular_frequency t + phase)', '1'), &
    item_row_type('load', 'amplitude', 'real', 1, 1, '', needed, '', '', '', 'law:harmonic', &
                  'largest distance of the factor from the mean', '1'), &
    item_row_type('load', 'angular_frequency', 'real', 1, 1, 'angle/s', needed, '', '', '', 'law:harmonic', &
                  'growth of the angle of the sine per second', '6.28'), &
    item_row_type('load', 'phase', 'real', 1, 1, 'angle', optional, '0', '', '', 'law:harmonic', &
                  'angle of the sine at t = 0', '1.57'), &
    item_row_type('load', 'file', 'text', 1, 1, 's, 1', needed, '', '', '', 'law:table', &
                  'a text file with t and the factor in each line, beside the data file; a smooth curve joins the points', &
                  '''force.dat'''), &
    item_row_type('load', 'times', 'real', 2, unlimited, 's', needed, '', '', '', 'law:segments', &
                  'the times at which segments begin and end, increasing', '0, 0.5, 1'), &
    item_row_type('load', 'values', 'real', 2, unlimited, '', needed, '', '', '', 'law:segments', &
                  'the factor at these times', '0, 1, 1'), &
    item_row_type('load', 'laws', 'text', 1, unlimited, '', needed, '', '', motion_laws, 'law:segments', &
                  'the motion law of each segment, or one for all', '''cycloidal'''), &
    item_row_type('load', 'period', 'real', 1, 1, 's', optional, '(no repetition)', '>0', '', 'law:segments law:table', &
                  'segments or table repeat after this time, which is that from the first to the last time', '1')]

  type(item_row_type), parameter :: motor_items(*) = [ &
    item_row_type('motor', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the independent coordinate on which it acts', '1'), &
    item_row_type('motor', 'kind', 'text', 1, 1, '', needed, '', '', 'dc pid', '', &
                  'dc: direct current at a given voltage; pid: a PID controller sets the force', '''dc'''), &
    item_row_type('motor', 'voltage', 'real', 1, 1, 'V', optional, '(1 with a law)', '', '', 'dc', &
                  'voltage, which a law multiplies if there is one', '24'), &
    item_row_type('motor', 'resistance', 'real', 1, 1, 'ohm', needed, '', '>0', '', 'dc', 'resistance of the circuit', '0.6'), &
    item_row_type('motor', 'inductance', 'real', 1, 1, 'H', optional, '0', '>=0', '', 'dc', &
                  'inductance of the circuit; 0: the current follows the voltage at once', '0.001'), &
    item_row_type('motor', 'constant', 'real', 1, 1, 'N m/A, N/A', needed, '', '>0', '', 'dc', &
                  'torque or force per current, which is also voltage per rad/s or m/s', '0.05'), &
    item_row_type('motor', 'gear_ratio', 'real', 1, 1, '', optional, '1', '', '', 'dc', &
                  'turns of the motor per turn of the coordinate; negative: the other way', '20', seldom=.true.), &
    item_row_type('motor', 'proportional', 'real', 1, 1, 'N m/rad, N/m', optional, '0', '>=0', '', 'pid', &
                  'force per deviation from the setpoint; per rad for angles, also with angle_unit=''deg''', '50'), &
    item_row_type('motor', 'integral', 'real', 1, 1, 'N m/rad/s', optional, '0', '>=0', '', 'pid', &
                  'force per time integral of the deviation', '20'), &
    item_row_type('motor', 'derivative', 'real', 1, 1, 'N m s, N s/m', optional, '0', '>=0', '', 'pid', &
                  'force per rate of the deviation', '5'), &
    item_row_type('motor', 'limit', 'real', 1, 1, 'N m, N', optional, '(none)', '>0', '', 'pid', &
                  'largest magnitude of the force; the integral is led back while the force is there', '8', seldom=.true.), &
    item_row_type('motor', 'setpoint', 'real', 1, 1, 'q', optional, '(by law)', '', '', 'pid', &
                  'a constant setpoint; one that changes is given by law in its place', '0.5'), &
    item_row_type('motor', 'law', 'text', 1, 1, '', optional, '''constant''', '', 'constant polynomial harmonic table segments', &
                  '', 'the form in time of the factor of voltage, or of the setpoint, with the names of &drive', '''harmonic''', &
                  seldom=.true.), &
    item_row_type('motor', 'over', 'text', 1, 1, '', optional, '''t''', '', '', any_law, variable_of_law, '''dq1'''), &
    item_row_type('motor', 'coefficients', 'real', 1, unlimited, '1 or q, /s', needed, '', '', '', 'law:polynomial', &
                  'c0, c1, c2, ... of the factor or setpoint c0 + c1 t + c2 t^2 + ...', '0, 0.5'), &
    item_row_type('motor', 'mean', 'real', 1, 1, '1 or q', optional, '0', '', '', 'law:harmonic', &
                  'the mean in the factor or setpoint mean + amplitude sin(angular_frequency t + phase)', '1'), &
    item_row_type('motor', 'amplitude', 'real', 1, 1, '1 or q', needed, '', '', '', 'law:harmonic', &
                  'largest distance from the mean', '1'), &
    item_row_type('motor', 'angular_frequency', 'real', 1, 1, 'angle/s', needed, '', '', '', 'law:harmonic', &
                  'growth of the angle of the sine per second', '6.28'), &
    item_row_type('motor', 'phase', 'real', 1, 1, 'angle', optional, '0', '', '', 'law:harmonic', &
                  'angle of the sine at t = 0', '1.57'), &
    item_row_type('motor', 'file', 'text', 1, 1, 's, 1 or q', needed, '', '', '', 'law:table', &
                  'a text file with t and factor or setpoint in each line, beside the data file; a smooth curve joins the points', &
                  '''voltage.dat'''), &
    item_row_type('motor', 'times', 'real', 2, unlimited, 's', needed, '', '', '', 'law:segments', &
                  'the times at which segments begin and end, increasing', '0, 0.5, 1'), &
    item_row_type('motor', 'values', 'real', 2, unlimited, '1 or q', needed, '', '', '', 'law:segments', &
                  'the factor or setpoint at these times', '0, 1, 1'), &
    item_row_type('motor', 'laws', 'text', 1, unlimited, '', needed, '', '', motion_laws, 'law:segments', &
                  'the motion law of each segment, or one for all', '''cycloidal'''), &
    item_row_type('motor', 'period', 'real', 1, 1, 's', optional, '(no repetition)', '>0', '', 'law:segments law:table', &
                  'segments or table repeat after this time, which is that from the first to the last time', '1')]

  type(item_row_type), parameter :: cam_items(*) = [ &
    item_row_type('cam', 'link', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the link that is the cam', '2'), &
    item_row_type('cam', 'follower', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the link that touches the cam with its roller or its flat face', '3'), &
    item_row_type('cam', 'point', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', '', &
                  'centre of the roller, or a point of the flat face, in the follower', '0, 0.05, 0'), &
    item_row_type('cam', 'roller', 'real', 1, 1, 'm', optional, '0', '>=0', '', '', &
                  'radius of the roller; 0 for a follower with an edge', '0.01'), &
    item_row_type('cam', 'face', 'real', 3, 3, '', optional, '(a roller)', '', '', '', &
                  'a flat face in place of a roller: its normal towards the cam, in the follower; of any length', '0, -1, 0', &
                  seldom=.true.), &
    item_row_type('cam', 'side', 'text', 1, 1, '', optional, '''inner''', '', 'inner outer', '', &
                  'inner: the path of the roller''s centre surrounds the cam; outer: the cam, a ring or a groove, surrounds it', &
                  '''outer''', seldom=.true.), &
    item_row_type('cam', 'axis', 'real', 3, 3, '', optional, '(of its pair, or z)', '', '', '', &
                  'normal of the cam''s plane, in the cam; by default the axis about which it turns', '0, 0, 1', seldom=.true.), &
    item_row_type('cam', 'guide', 'integer', 1, 1, '', optional, '(found)', '>=1', '', '', &
                  'coordinate of the pair that guides the follower, for the pressure angle; by default its pair with link 1', '2', &
                  seldom=.true.)]

  type(item_row_type), parameter :: run_items(*) = [ &
    item_row_type('time', 'start', 'real', 1, 1, 's', optional, '0', '', '', '', 'time of the first result', '0'), &
    item_row_type('time', 'end', 'real', 1, 1, 's', optional, '1', '', '', '', 'time of the last result', '2.5'), &
    item_row_type('time', 'intervals', 'integer', 1, 1, '', optional, '100', '>=0', '', '', &
                  'number of intervals between the results; 0 for the start alone', '200'), &
    item_row_type('time', 'at', 'real', 1, 1, 's', optional, '(start to end)', '', '', '', &
                  'one instant: one result at this time, in place of start, end and intervals', '0.3', seldom=.true.), &
    item_row_type('solver', 'method', 'text', 1, 1, '', optional, '''auto''', '', &
                  'auto prince-dormand dormand-prince verner fehlberg merson adams bdf', '', &
                  'the method of integration; auto: prince-dormand, and bdf while the motion is stiff', '''bdf'''), &
    item_row_type('solver', 'accuracy', 'real', 1, 1, '', optional, '0', '>=0', '', '', &
                  'largest error of an output, in units of this file; other runs tell it, tolerances follow; 0: not asked for', &
                  '1e-8', seldom=.true.), &
    item_row_type('solver', 'relative_tolerance', 'real', 1, 1, '', optional, '1e-8', '>0 and <1', '', '', &
                  'error allowed in each step, relative to coordinates and rates; errors add up, see '// &
                  'docs/explanation/accuracy.md', &
                  '1e-8', seldom=.true.), &
    item_row_type('solver', 'absolute_tolerance', 'real', 1, 1, '', optional, '1e-10', '>0', '', '', &
                  'error allowed in a step, in rad, m and their rates', '1e-10', seldom=.true.), &
    item_row_type('solver', 'maximum_steps', 'integer', 1, 1, '', optional, '1000000', '>=1', '', '', &
                  'most steps between two results', '10000', seldom=.true.), &
    item_row_type('user', 'parameters', 'real', 1, unlimited, '', optional, '(none)', '', '', '', &
                  'numbers that every user procedure receives', '0.1, 2.0')]

  type(item_row_type), parameter :: stop_items(*) = [ &
    item_row_type('stop', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the coordinate', '4'), &
    item_row_type('stop', 'low', 'real', 1, 1, 'q', optional, '(no end)', '', '', '', &
                  'least value of the coordinate', '0'), &
    item_row_type('stop', 'high', 'real', 1, 1, 'q', optional, '(no end)', '', '', '', &
                  'greatest value of the coordinate', '0.1'), &
    item_row_type('stop', 'restitution', 'real', 1, 1, '', optional, '0', '>=0', '', '', &
                  'of a rigid stop: rate after an impact over the rate before it, from 0 to 1', '0.6'), &
    item_row_type('stop', 'stiffness', 'real', 1, 1, '', optional, '(rigid)', '>0', '', '', &
                  'makes the stop compliant: force (N m, N) = d^exponent (stiffness + damping dd/dt), penetration d in rad or m', &
                  '1e5', seldom=.true.), &
    item_row_type('stop', 'damping', 'real', 1, 1, '', optional, '0', '>=0', '', '', &
                  'of a compliant stop: force per rate of the penetration, at a penetration of 1 rad or 1 m', '200', &
                  seldom=.true.), &
    item_row_type('stop', 'exponent', 'real', 1, 1, '', optional, '1', '>=1', '', '', &
                  'of a compliant stop: power of the penetration; 1.5 for balls (Hertz)', '1.5', seldom=.true.)]

  type(item_row_type), parameter :: friction_items(*) = [ &
    item_row_type('friction', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the coordinate', '4'), &
    item_row_type('friction', 'dynamic', 'real', 1, 1, '', needed, '', '>=0', '', '', &
                  'coefficient of friction while the pair moves', '0.15'), &
    item_row_type('friction', 'static', 'real', 1, 1, '', optional, '(dynamic)', '>=0', '', '', &
                  'coefficient of friction at rest, not less than dynamic', '0.2', seldom=.true.), &
    item_row_type('friction', 'radius', 'real', 1, 1, 'm', optional, '0', '>=0', '', '', &
                  'of the bearing of a turning pair, on which forces across the axis press; mean one of a thread', '0.01'), &
    item_row_type('friction', 'face_radius', 'real', 1, 1, 'm', optional, '0', '>=0', '', '', &
                  'mean radius of the face of a turning pair on which forces along the axis press', '0.015', seldom=.true.), &
    item_row_type('friction', 'arm', 'real', 1, 1, 'm', optional, '(no moments)', '>0', '', '', &
                  'half length of the guide of a sliding pair: moments across the axis press with moment/arm', '0.05', &
                  seldom=.true.), &
    item_row_type('friction', 'preload', 'real', 1, 1, 'N, N m', optional, '0', '>=0', '', '', &
                  'what presses without any load, beside the forces: N, in a turning pair N m', '5', seldom=.true.), &
    item_row_type('friction', 'law', 'text', 1, 1, '', optional, '''coulomb''', '', 'coulomb smooth', '', &
                  'coulomb: the pair sticks and slips; smooth: it creeps, with the force tanh(rate/transition)', '''coulomb''', &
                  seldom=.true.), &
    item_row_type('friction', 'transition', 'real', 1, 1, 'q/s', optional, '(none)', '>0', '', '', &
                  'of the smooth law: rate at which the friction has 76 % of its force', '0.01', seldom=.true.)]

  type(item_row_type), parameter :: contact_items(*) = [ &
    item_row_type('contact', 'point', 'text', 1, 1, '', needed, '', '', '', '', &
                  'name of the &point that touches, or about which the ball is', '''P'''), &
    item_row_type('contact', 'link', 'integer', 1, 1, '', optional, '1', '>=1', '', '', &
                  'number of the link with the surface', '1'), &
    item_row_type('contact', 'kind', 'text', 1, 1, '', optional, '''plane''', '', 'plane sphere path', '', &
                  'of the surface; path: a curve in a plane, and along the axis of this plane', '''plane'''), &
    item_row_type('contact', 'origin', 'real', 3, 3, 'm', optional, '0, 0, 0', '', '', '', &
                  'a point of the plane, centre of the sphere, or origin of the path, in the system of its link', '0, 0, 0'), &
    item_row_type('contact', 'normal', 'real', 3, 3, '', optional, '0, 0, 1', '', '', '', &
                  'of the plane, towards its free side, in the axes of its link', '0, 0, 1'), &
    item_row_type('contact', 'radius', 'real', 1, 1, 'm', optional, '0', '>=0', '', '', &
                  'of the ball about the point; 0 for the point itself', '0.05'), &
    item_row_type('contact', 'other_radius', 'real', 1, 1, 'm', optional, '0', '>=0', '', '', &
                  'of the sphere that is the surface', '0.1', seldom=.true.), &
    item_row_type('contact', 'file', 'text', 1, 1, 'm', optional, '(none)', '', '', '', &
                  'of a path: a text file with x and y in each line, beside the data file; an empty line makes a corner', &
                  '''cam.dat''', seldom=.true.), &
    item_row_type('contact', 'columns', 'integer', 2, 2, '', optional, '(all)', '>=1', '', '', &
                  'of a path: the columns of x and y in a file that has others too', '3, 4', seldom=.true.), &
    item_row_type('contact', 'scale', 'real', 1, 1, '', optional, '1', '>0', '', '', &
                  'of a path: the coordinates in the file are multiplied by this number', '0.001', seldom=.true.), &
    item_row_type('contact', 'axis', 'real', 3, 3, '', optional, '0, 0, 1', '', '', '', &
                  'of a path: z axis of the coordinates in the file, in the axes of its link', '0, 0, 1', seldom=.true.), &
    item_row_type('contact', 'zero', 'real', 3, 3, '', optional, '(x, y or z axis)', '', '', '', &
                  'of a path: x axis of the coordinates in the file, in the axes of its link', '1, 0, 0', seldom=.true.), &
    item_row_type('contact', 'closed', 'logical', 1, 1, '', optional, '(where ends meet)', '', '', '', &
                  'of a path: it has no ends; by default where the last point of its file is the first one again', '.true.', &
                  seldom=.true.), &
    item_row_type('contact', 'side', 'text', 1, 1, '', optional, '(outside)', '', 'left right outside inside', '', &
                  'of a path: where the ball is, seen along the curve with the axis up, or of a closed curve', '''left''', &
                  seldom=.true.), &
    item_row_type('contact', 'restitution', 'real', 1, 1, '', optional, '0', '>=0', '', '', &
                  'of a rigid contact: rate of the gap after an impact over the rate before it, from 0 to 1', '0.6'), &
    item_row_type('contact', 'friction', 'real', 1, 1, '', optional, '0', '>=0', '', '', &
                  'coefficient of friction while the contact slides', '0.3'), &
    item_row_type('contact', 'static_friction', 'real', 1, 1, '', optional, '(friction)', '>=0', '', '', &
                  'coefficient of friction at rest, not less than friction', '0.4', seldom=.true.), &
    item_row_type('contact', 'stiffness', 'real', 1, 1, '', optional, '(rigid)', '>0', '', '', &
                  'makes the contact compliant: force (N) = d^exponent (stiffness + damping dd/dt), penetration d in m', &
                  '1e5', seldom=.true.), &
    item_row_type('contact', 'damping', 'real', 1, 1, '', optional, '0', '>=0', '', '', &
                  'of a compliant contact: force per rate of the penetration, at a penetration of 1 m', '200', seldom=.true.), &
    item_row_type('contact', 'exponent', 'real', 1, 1, '', optional, '1', '>=1', '', '', &
                  'of a compliant contact: power of the penetration; 1.5 for balls (Hertz)', '1.5', seldom=.true.)]

  type(item_row_type), parameter :: item_table(*) = &
    [general_items, pair_items, link_items, coupling_items, motion_items, body_items, load_items, motor_items, stop_items, &
     friction_items, contact_items, cam_items, study_items, long_term_items, run_items, output_items]

contains

  !> Row of a group in group_table; 0 where there is no such group.
  pure integer function find_group_row(name) result(row)
    character(len=*), intent(in) :: name  !< name of a group, in any case

    row = row_of_group(lower(name))
  end function find_group_row

  !> Row of a group in group_table; 0 where there is no such group.
  pure integer function row_of_group(name) result(row)
    character(len=*), intent(in) :: name  !< name of a group, in lower case

    row = 0
    if (len(name) == 0) return
    do row = size(group_table), 1, -1
      if (group_table(row)%name(1:1) /= name(1:1)) cycle
      if (group_table(row)%name == name) return
    end do
  end function row_of_group

  !> Rows of a group's names in item_table.
  pure function rows_of_group(group) result(rows)
    character(len=*), intent(in) :: group  !< name of a group, in any case
    integer, allocatable :: rows(:)
    integer :: i

    rows = pack([(i, i=1, size(item_table))], item_table%group == lower(group))
  end function rows_of_group

  !> The names of all groups, blank-padded.
  pure function names_of_groups() result(names)
    character(len=len(group_table%name)), allocatable :: names(:)

    names = group_table%name
  end function names_of_groups

  !> The names of a group; a name with several rows is repeated.
  pure function names_in_group(group) result(names)
    character(len=*), intent(in) :: group  !< name of a group, in any case
    character(len=len(item_table%name)), allocatable :: names(:)

    names = pack(item_table%name, item_table%group == lower(group))
  end function names_in_group

  !> The words of a list with blanks between.
  pure function words_of(list) result(words)
    character(len=*), intent(in) :: list  !< words with blanks between them
    character(len=len(list)), allocatable :: words(:)
    integer :: first, last

    allocate (words(0))
    first = verify(list, ' ')
    do while (first > 0)
      last = index(list(first:)//' ', ' ') + first - 2
      words = [character(len=len(list)) :: words, list(first:last)]
      first = verify(list(min(last + 1, len(list)):), ' ')
      if (last == len(list)) exit
      if (first > 0) first = first + last
    end do
  end function words_of
end module mech9_grammar
