!> The explanation that `?` gives of each name of the data file in a conversation: whole sentences, and examples in the
!> unit of the question.
!>
!> The table of names (the grammar) has a few words on each name, for lists; the sentences here are for newcomers. Every
!> row of the grammar has its row here, which a test checks.
module mech9_explanations
  implicit none
  private
  public :: explanation_type, find_explanation, explanations

  !> The explanation of one name.
  type :: explanation_type
    character(len=9) :: group
    character(len=18) :: name
    character(len=32) :: kinds                 !< kinds as in the grammar, which tell rows of one name apart
    character(len=275) :: text                 !< whole sentences
    character(len=84) :: example               !< a value as it is typed, for angles in rad, and its meaning in parentheses
    character(len=84) :: degrees = ''          !< the same for an angle in degrees; empty: as in rad
    character(len=84) :: length = ''           !< the same for a coordinate that is a length; empty: as for an angle
  end type explanation_type

  type(explanation_type), parameter :: general_texts(*) = [ &
    explanation_type('mechanism', 'title', '', &
                  'The title heads the table of results, the plots and the drawings, and the names of files are made '// &
                  'from it.', 'Crank with two slides'), &
    explanation_type('mechanism', 'links', '', &
                  'Count every rigid part, and the frame too: the frame is link 1, and the others have the numbers 2, 3 '// &
                  'and so on in any order.', '4 (a four-bar linkage: frame, crank, coupler and rocker)'), &
    explanation_type('mechanism', 'coordinates', '', &
                  'Each pair joins two links and has one coordinate, an angle or a length, so this is the number of '// &
                  'pairs. A joint with more than one freedom is built of several pairs with massless links of size zero '// &
                  'between them: a ball joint takes three revolute pairs and two more links.', &
                  '4 (a four-bar linkage has four hinges)'), &
    explanation_type('mechanism', 'angle_unit', '', &
                  'All angles that you type and all angles in the results are in this unit, and their rates in this unit '// &
                  'per second.', 'deg'), &
    explanation_type('mechanism', 'data_tolerance', '', &
                  'Points and directions from a drawing have a few digits only, and a mechanism that moves by its exact '// &
                  'dimensions alone would be locked. Its redundant equations may stay open by this part of its size, and '// &
                  'by as many rad. Leave it at 0 where the dimensions are exact.', '1e-6'), &
    explanation_type('structure', 'c', '', &
                  'Row i of the coincidence matrix has a number for each link: the number of the pair that joins link i '// &
                  'to that link, and 0 where none does. The matrix is symmetric.', &
                  '0, 1, 0, 4 (row 1: the frame meets link 2 in pair 1, and link 4 in pair 4)'), &
    explanation_type('structure', 'cq', '', &
                  'The independent coordinates are those that you prescribe as functions of time in mech9k, or whose '// &
                  'start you give in mech9d; all others follow from them. Give as many as the mechanism has degrees of '// &
                  'freedom, by the numbers of their pairs.', &
                  '1 (the crank of a four-bar linkage turns in pair 1; its other angles follow)'), &
    explanation_type('structure', 'nrg', '', &
                  'The second set describes the closed chains in the order of computation. Its first list has the links '// &
                  'as they are passed through; each chain begins and ends at links that are known already.', &
                  '1, 2, 3, 4, 1 (a four-bar linkage: from the frame around to the frame)'), &
    explanation_type('structure', 'nws', '', &
                  'The second list has, for each link of nrg, the number of the pair that leads to it from the link '// &
                  'before, and 0 where a chain starts.', '0, 1, 2, 3, 4 (a four-bar linkage)'), &
    explanation_type('structure', 'rdw', '', &
                  'The third list has, for each link of nrg, 1 where the pair of nws is independent or a chain starts, '// &
                  'and 0 elsewhere.', '1, 1, 0, 0, 0 (a four-bar linkage that is driven in pair 1)'), &
    explanation_type('structure', 'nrw', '', &
                  'The fourth list has, for each link of nrg, the number of chains that are closed up to there. It can '// &
                  'be left out, since it follows from the others.', '0, 0, 0, 0, 1 (a four-bar linkage)')]

  type(explanation_type), parameter :: pair_texts(*) = [ &
    explanation_type('pair', 'coordinate', '', &
                  'Every pair has a coordinate, and pair and coordinate have the same number.', '5'), &
    explanation_type('pair', 'links', '', &
                  'Name the two links that the pair joins by their numbers. The first is the reference link, in whose '// &
                  'system the pair is described; the second is the moving link. A positive coordinate moves the second '// &
                  'against the first.', '1-2 (the same as 1, 2: link 2 moves against the frame)'), &
    explanation_type('pair', 'kind', '', &
                  'A revolute pair is a hinge, a prismatic pair is a slide, a helical pair is a screw, a path pair leads '// &
                  'its moving link along a curve, and a user pair moves as a procedure of your own says. The first '// &
                  'letters will do.', 'rev'), &
    explanation_type('pair', 'point', 'revolute prismatic helical', &
                  'Give any point of the axis by its coordinates in the reference link. Where the mechanism is described '// &
                  'in one position, in which all link systems coincide, these are coordinates in the frame. The '// &
                  'direction alone matters for a slide.', '0.3, 0, 0 (0.3 m from the origin along x)'), &
    explanation_type('pair', 'axis', 'revolute prismatic helical', &
                  'Give the direction of the axis by three components in the reference link; its length does not matter. '// &
                  'The moving link turns about it by the right-hand rule, or slides along it. The letters x, y, z and '// &
                  '-x, -y, -z will do.', 'z (the same as 0, 0, 1: a hinge of a mechanism in the plane of x and y)'), &
    explanation_type('pair', 'zero', 'revolute prismatic helical', &
                  'The coordinate is counted from this direction, which lies in the reference link and is made '// &
                  'perpendicular to the axis. It matters only together with moving_zero or with other link systems in '// &
                  'the two links; otherwise the default serves.', 'x'), &
    explanation_type('pair', 'moving_point', 'revolute prismatic helical', &
                  'Give the same point of the axis by its coordinates in the moving link. It is needed only where the '// &
                  'systems of the two links do not coincide when the coordinate is 0.', &
                  '0, 0, 0 (the moving link has its origin in this pair)'), &
    explanation_type('pair', 'moving_axis', 'revolute prismatic helical', &
                  'Give the direction of the same axis by components in the moving link. It is needed only where the '// &
                  'systems of the two links do not coincide when the coordinate is 0.', 'z'), &
    explanation_type('pair', 'moving_zero', 'revolute prismatic helical', &
                  'This direction of the moving link points along the direction zero of the reference link when the '// &
                  'coordinate is 0.', 'x'), &
    explanation_type('pair', 'pitch', 'helical', &
                  'The moving link advances by this length in each turn: forwards along the axis where it turns by the '// &
                  'right-hand rule, backwards for a negative pitch.', '0.005 (5 mm a turn)'), &
    explanation_type('pair', 'dh', 'revolute prismatic helical', &
                  'The four Denavit-Hartenberg parameters are a length, an angle, a length and an angle: the moving link '// &
                  'is turned by theta about z, moved by d along z, moved by a along x, and turned by alpha about x. They '// &
                  'stand instead of point, axis and the other directions.', &
                  '0.3, 1.5708, 0, 0 (0.3 m along x, then the next axis at a right angle)', &
                  '0.3, 90, 0, 0 (0.3 m along x, then the next axis at a right angle)'), &
    explanation_type('pair', 'file', 'path', &
                  'Name a text file that has the coordinates of a point in each line, beside the data file: x and y, or x, y '// &
                  'and z. A smooth curve is laid through them; there must be at least four. If the last point is the first '// &
                  'one again, the curve is closed.', 'curve.dat (with lines such as: 0.1 0.25)'), &
    explanation_type('pair', 'columns', 'path', &
                  'A file can have further columns, as a table of results or of a cam has. Tell in which columns x and y '// &
                  'stand, and in space z.', '3, 4 (x is the third number of each line, y the fourth)'), &
    explanation_type('pair', 'orientation', 'path', &
                  'The moving link can keep its orientation while one of its points follows the curve, or turn with the '// &
                  'tangent of the curve, as a train does on its rails.', 'tangent'), &
    explanation_type('pair', 'closed', 'path', &
                  'A closed curve repeats: the coordinate, a length along it, may grow beyond its length. The file says it by '// &
                  'its last point, which is the first one again; this name is for those that are to be read otherwise.', &
                  '.false.'), &
    explanation_type('pair', 'point', 'path', &
                  'This is the origin of the coordinates in the file of the curve, given in the reference link.', '0, 0.2, 0'), &
    explanation_type('pair', 'axis', 'path', &
                  'This direction of the reference link is the z axis of the coordinates in the file of the curve. The letters '// &
                  'x, y, z and -x, -y, -z will do.', 'z'), &
    explanation_type('pair', 'zero', 'path', &
                  'This direction of the reference link is the x axis of the coordinates in the file of the curve; it is made '// &
                  'perpendicular to axis.', 'x'), &
    explanation_type('pair', 'moving_point', 'path', &
                  'This point of the moving link follows the curve.', '0.1, 0, 0'), &
    explanation_type('pair', 'moving_axis', 'path', &
                  'This direction of the moving link stays along axis where the link keeps its orientation or the '// &
                  'curve lies in a plane; else it stays across the tangent.', 'z'), &
    explanation_type('pair', 'moving_zero', 'path', &
                  'This direction of the moving link stays along zero, or along the tangent where the link turns with the '// &
                  'curve.', 'x')]

  type(explanation_type), parameter :: motion_texts(*) = [ &
    explanation_type('initial', 'coordinate', '', &
                  'This is the number of the coordinate whose start is given.', '4'), &
    explanation_type('initial', 'position', '', &
                  'Give the value of an independent coordinate at the start. For a dependent coordinate a rough guess is '// &
                  'enough: it chooses one of the ways in which the links can be put together.', &
                  '0.7854 (an eighth of a turn from the position in which the mechanism is described)', &
                  '45 (an eighth of a turn from the position in which the mechanism is described)', &
                  '0.1 (0.1 m from the position in which the mechanism is described)'), &
    explanation_type('initial', 'velocity', '', &
                  'Give the rate at which the independent coordinate begins to move.', &
                  '6.2832 (one turn a second; 0 lets it go at rest)', '360 (one turn a second; 0 lets it go at rest)', &
                  '0.5 (half a metre a second; 0 lets it go at rest)'), &
    explanation_type('point', 'name', '', &
                  'A point with a name is recorded: its position, velocity and acceleration become columns such as P.x. '// &
                  'A name has letters, digits and _. Enter goes on without a further point.', 'P'), &
    explanation_type('point', 'link', '', &
                  'The point is fixed in this link and moves with it.', '3'), &
    explanation_type('point', 'position', '', &
                  'Give the coordinates of the point in the system of its link. Where the mechanism is described in one '// &
                  'position, in which all link systems coincide, these are its coordinates in the frame in that position.', &
                  '1.0, 0.3, 0'), &
    explanation_type('drive', 'coordinate', '', &
                  'This is the number of the independent coordinate that moves as the drive says.', '5'), &
    explanation_type('drive', 'kind', '', &
                  'A polynomial drive is a power series of time, such as a constant speed; a harmonic drive swings as a '// &
                  'sine; a table drive is a smooth curve through a file''s points; a segments drive has the motion laws of '// &
                  'cams; a user drive is your procedure.', 'polynomial'), &
    explanation_type('drive', 'coefficients', 'polynomial', &
                  'The coordinate is q = c0 + c1 t + c2 t^2 + ..., with the time t in seconds. Give c0, its value at t = '// &
                  '0, then c1, its rate at t = 0, then c2, half its acceleration, and as many more as you need.', &
                  '0, 6.2832 (begins at 0 rad and turns once a second)', '0, 360 (begins at 0 deg and turns once a second)', &
                  '0.1, 0.05 (begins at 0.1 m and slides 0.05 m each second)'), &
    explanation_type('drive', 'mean', 'harmonic', &
                  'The coordinate is q = mean + amplitude sin(angular_frequency t + phase). It swings to both sides of '// &
                  'the mean.', '0.7854 (swings about an eighth of a turn)', '45 (swings about an eighth of a turn)', &
                  '0.2 (swings about 0.2 m)'), &
    explanation_type('drive', 'amplitude', 'harmonic', &
                  'The coordinate is q = mean + amplitude sin(angular_frequency t + phase). It goes as far as the '// &
                  'amplitude to each side of the mean.', '0.5236 (a twelfth of a turn to each side)', &
                  '30 (a twelfth of a turn to each side)', '0.05 (0.05 m to each side)'), &
    explanation_type('drive', 'angular_frequency', 'harmonic', &
                  'The coordinate is q = mean + amplitude sin(angular_frequency t + phase). A full swing to and fro '// &
                  'takes the time of a full turn divided by the angular frequency.', &
                  '6.2832 (one swing to and fro each second)', '360 (one swing to and fro each second)'), &
    explanation_type('drive', 'phase', 'harmonic', &
                  'The coordinate is q = mean + amplitude sin(angular_frequency t + phase). The phase says where in its '// &
                  'swing the coordinate is at t = 0: with a phase of 0 it is at the mean and grows.', &
                  '1.5708 (begins at mean + amplitude)', '90 (begins at mean + amplitude)'), &
    explanation_type('drive', 'file', 'table', &
                  'Name a text file that has a time and the value of the coordinate in each line, beside the data file. '// &
                  'A smooth curve is laid through them; there must be at least four, from the first to the last time of '// &
                  'the run.', 'motion.dat (with lines such as: 0.25 0.7854)', 'motion.dat (with lines such as: 0.25 45)', &
                  'motion.dat (with lines such as: 0.25 0.1)'), &
    explanation_type('drive', 'times', 'segments', &
                  'Segments begin and end at these times in seconds, which increase: three times make two segments. They '// &
                  'cover the times of the run, unless they repeat.', '0, 0.5, 1'), &
    explanation_type('drive', 'values', 'segments', &
                  'Give the coordinate at each of the times, as many numbers as there are times.', '0, 1, 1', '0, 90, 90', &
                  '0, 0.02, 0.02'), &
    explanation_type('drive', 'laws', 'segments', &
                  'Each segment goes from its first value to its last by a motion law of cam design, and by dwell where both '// &
                  'values are the same. One law serves for all segments.', 'cycloidal, dwell (two segments)'), &
    explanation_type('drive', 'period', 'segments', &
                  'With a period the segments repeat. It is the time from the first to the last of the times.', '1')]

  type(explanation_type), parameter :: body_texts(*) = [ &
    explanation_type('body', 'link', '', &
                  'A body gives a link its mass, mass centre and inertia. Name the link by its number. Enter goes on '// &
                  'without a further body.', '3'), &
    explanation_type('body', 'mass', '', &
                  'Give the mass of the link in kilograms.', '2.0'), &
    explanation_type('body', 'centre', '', &
                  'Give the mass centre by its coordinates in the system of the link. Where the mechanism is described '// &
                  'in one position, in which all link systems coincide, these are its coordinates in the frame in that '// &
                  'position.', '1.6, 0.4, 0'), &
    explanation_type('body', 'inertia', '', &
                  'Give six elements of the inertia tensor about the mass centre, along the axes of the link, in the order '// &
                  'xx, yy, zz, xy, xz, yz; xy is minus the integral of x y dm. In a mechanism that moves in the plane of x '// &
                  'and y only zz has an influence, and the others may be 0.', &
                  '0, 0, 0.083, 0, 0, 0 (a slender rod of 1 kg and 1 m in that plane)'), &
    explanation_type('gravity', 'acceleration', '', &
                  'Give the acceleration of gravity by its components along the axes of the frame. The letters x, y, z '// &
                  'and -x, -y, -z mean 9.81 m/s^2 along that axis, and none means no gravity.', &
                  '-y (the same as 0, -9.81, 0: y points up)')]

  type(explanation_type), parameter :: load_texts(*) = [ &
    explanation_type('load', 'kind', '', &
                  'A force or a torque acts on one link. A spring, which can have damping too, joins points of two '// &
                  'links. A load of kind coordinate is a spring, a damper or a constant torque or force in one pair. A '// &
                  'user load is a procedure of your own. Enter goes on without a further load.', 'spring'), &
    explanation_type('load', 'link', 'force torque', &
                  'The force or torque acts on this link.', '5'), &
    explanation_type('load', 'links', 'spring', &
                  'The spring joins a point of the first link to a point of the second one. Link 1 is the frame.', &
                  '1-3 (the same as 1, 3: from the frame to link 3)'), &
    explanation_type('load', 'coordinate', 'coordinate', &
                  'The load acts in the pair with this number: on its moving link, and with opposite sign on its '// &
                  'reference link.', '1'), &
    explanation_type('load', 'position', 'force spring', &
                  'Give the point at which the force acts, or at which the first end of the spring is fixed, by its '// &
                  'coordinates in the system of that link.', '1.0, 0, 0'), &
    explanation_type('load', 'second_position', 'spring', &
                  'Give the point at which the second end of the spring is fixed, by its coordinates in the system of '// &
                  'the second link.', '0, 0.3, 0'), &
    explanation_type('load', 'force', 'force', &
                  'Give the three components of the force. They are along the axes of the frame, or along those of the '// &
                  'link where frame says so.', '0, -10, 0 (10 N against the direction of y)'), &
    explanation_type('load', 'force', 'coordinate', &
                  'This is a constant part of the load, a torque in a revolute pair and a force in a prismatic pair. A '// &
                  'positive one drives the coordinate upwards.', '2.5 (a motor with 2.5 N m)', '2.5 (a motor with 2.5 N m)', &
                  '2.5 (a constant force of 2.5 N)'), &
    explanation_type('load', 'torque', 'torque', &
                  'Give the three components of the torque. They are along the axes of the frame, or along those of the '// &
                  'link where frame says so.', '0, 0, 4 (4 N m about z)'), &
    explanation_type('load', 'frame', 'force torque', &
                  'A load that is fixed keeps its direction in space; a load of the frame link turns with the link.', 'link'), &
    explanation_type('load', 'stiffness', 'spring', &
                  'The spring pulls with this force for each metre by which it is longer than its free length. A damper '// &
                  'alone has stiffness 0.', '200 (2 N for each centimetre)'), &
    explanation_type('load', 'stiffness', 'coordinate', &
                  'The load is -stiffness (q - rest) - damping dq/dt + force. The stiffness of an angle is per rad, '// &
                  'whatever angle_unit says; a negative one drives the coordinate away from rest.', &
                  '200 (200 N m for each rad)', '200 (200 N m for each rad, which is 3.49 N m for each deg)', &
                  '200 (2 N for each centimetre)'), &
    explanation_type('load', 'free_length', 'spring', &
                  'At this length the spring neither pulls nor pushes.', '0.5'), &
    explanation_type('load', 'rest', 'coordinate', &
                  'At this value of the coordinate the spring in the pair is at rest.', '0.5236 (a twelfth of a turn)', &
                  '30 (a twelfth of a turn)', '0.05'), &
    explanation_type('load', 'damping', 'spring', &
                  'The damper pulls with this force for each metre per second at which the distance of its ends grows.', '1.5'), &
    explanation_type('load', 'damping', 'coordinate', &
                  'The load is -stiffness (q - rest) - damping dq/dt + force. The damping of an angle is per rad/s, '// &
                  'whatever angle_unit says.', '0.1 (0.1 N m for each rad/s)', '0.1 (0.1 N m for each rad/s)', &
                  '1.5 (1.5 N for each m/s)'), &
    explanation_type('load', 'law', 'force torque spring coordinate', &
                  'The load is multiplied by a number that depends on time as a drive does: constant, polynomial, harmonic, '// &
                  'table or segments.', 'harmonic'), &
    explanation_type('load', 'coefficients', 'law:polynomial', &
                  'The factor is c0 + c1 t + c2 t^2 + ..., with the time t in seconds.', '0, 0.5 (grows by a half each second)'), &
    explanation_type('load', 'mean', 'law:harmonic', &
                  'The factor is mean + amplitude sin(angular_frequency t + phase).', '1'), &
    explanation_type('load', 'amplitude', 'law:harmonic', &
                  'The factor is mean + amplitude sin(angular_frequency t + phase).', '0.5'), &
    explanation_type('load', 'angular_frequency', 'law:harmonic', &
                  'The factor is mean + amplitude sin(angular_frequency t + phase).', &
                  '6.2832 (one swing to and fro each second)', '360 (one swing to and fro each second)'), &
    explanation_type('load', 'phase', 'law:harmonic', &
                  'The factor is mean + amplitude sin(angular_frequency t + phase).', &
                  '1.5708 (begins at mean + amplitude)', '90 (begins at mean + amplitude)'), &
    explanation_type('load', 'file', 'law:table', &
                  'Name a text file that has a time and the factor in each line, beside the data file.', 'force.dat'), &
    explanation_type('load', 'times', 'law:segments', &
                  'Segments begin and end at these times in seconds, which increase: three times make two segments. They '// &
                  'cover the times of the run, unless they repeat.', '0, 0.5, 1'), &
    explanation_type('load', 'values', 'law:segments', &
                  'Give the factor at each of the times, as many numbers as there are times.', '0, 1, 1'), &
    explanation_type('load', 'laws', 'law:segments', &
                  'Each segment goes from its first value to its last by a motion law of cam design, and by dwell where both '// &
                  'values are the same. One law serves for all segments.', 'cycloidal, dwell (two segments)'), &
    explanation_type('load', 'period', 'law:segments', &
                  'With a period the segments repeat. It is the time from the first to the last of the times.', '1')]

  type(explanation_type), parameter :: coupling_texts(*) = [ &
    explanation_type('coupling', 'kind', '', &
                  'A gear or a belt couples two coordinates that turn, a rack or a screw one that turns and one that slides. '// &
                  'linear couples any coordinates by a sum with coefficients. Enter goes on without a further coupling.', 'gear'), &
    explanation_type('coupling', 'coordinates', '', &
                  'Give the numbers of the coordinates. The first one moves the second; only a linear coupling may have more.', &
                  '1, 2'), &
    explanation_type('coupling', 'ratio', 'gear', &
                  'The second coordinate turns so many times while the first one turns once. It is negative for two gears that '// &
                  'mesh from outside, because they turn in opposite directions.', '-2.5'), &
    explanation_type('coupling', 'radius', 'rack', &
                  'The rack slides by this radius while the pinion turns by 1 rad. A negative radius reverses it.', '0.02'), &
    explanation_type('coupling', 'radii', 'belt', &
                  'Give the radius of the pulley of the first coordinate and that of the second one.', '0.05, 0.1'), &
    explanation_type('coupling', 'crossed', 'belt', &
                  'With a crossed belt the pulleys turn in opposite directions.', '.true.'), &
    explanation_type('coupling', 'pitch', 'screw', &
                  'The second coordinate slides by the pitch while the first one makes a turn.', '0.005'), &
    explanation_type('coupling', 'phase', 'gear rack belt screw', &
                  'The second coordinate has this value where the first one is zero. Without it both have their initial '// &
                  'positions together.', '0'), &
    explanation_type('coupling', 'coefficients', 'linear', &
                  'The sum of these numbers, each times its coordinate, is constant. Give one for each coordinate.', '1, -2, 1'), &
    explanation_type('coupling', 'constant', 'linear', &
                  'The sum of the coefficients times the coordinates has this value.', '0')]

  type(explanation_type), parameter :: motor_texts(*) = [ &
    explanation_type('motor', 'coordinate', '', &
                  'A motor acts on an independent coordinate without a drive. Name it by its number. Enter goes on without a '// &
                  'further motor.', '1'), &
    explanation_type('motor', 'kind', '', &
                  'A dc motor runs on direct current: its torque grows with its current. The torque of a pid motor is set by '// &
                  'a controller, so that the coordinate follows a setpoint.', 'dc'), &
    explanation_type('motor', 'voltage', 'dc', &
                  'Give the voltage at the motor. Where a law of time is given too, it is multiplied by the law.', '24'), &
    explanation_type('motor', 'resistance', 'dc', &
                  'The voltage less that of the turning motor, over the resistance, is the steady current.', '0.6'), &
    explanation_type('motor', 'inductance', 'dc', &
                  'The inductance delays the current by inductance over resistance, in seconds; with 0 it follows at once.', &
                  '0.001'), &
    explanation_type('motor', 'constant', 'dc', &
                  'The torque for each ampere, and also the voltage for each radian per second; of a linear motor the force, '// &
                  'and the voltage for each metre per second.', '0.05 (0.05 N m for each ampere)'), &
    explanation_type('motor', 'gear_ratio', 'dc', &
                  'The motor turns so many times while the coordinate turns once.', '20'), &
    explanation_type('motor', 'proportional', 'pid', &
                  'The torque or force for each radian or metre by which the coordinate is short of the setpoint.', &
                  '50 (50 N m for each rad)', '50 (50 N m for each rad)', '500 (500 N for each m)'), &
    explanation_type('motor', 'integral', 'pid', &
                  'The torque or force for each second during which the coordinate is 1 rad or 1 m short of the setpoint. It '// &
                  'removes deviations that a constant load leaves.', '20'), &
    explanation_type('motor', 'derivative', 'pid', &
                  'The torque or force for each rad/s or m/s by which the setpoint is faster than the coordinate. It damps.', &
                  '5'), &
    explanation_type('motor', 'limit', 'pid', &
                  'The torque or force is never larger. While it is at its limit, the integral is led back.', '8'), &
    explanation_type('motor', 'setpoint', 'pid', &
                  'The coordinate is to have this value. A setpoint that changes in time is given by a law, and none here.', &
                  '0.5', '30', '0.2'), &
    explanation_type('motor', 'law', '', &
                  'The voltage is multiplied by a number that depends on time as a drive does, or the setpoint depends on time '// &
                  'so: constant, polynomial, harmonic, table or segments.', 'harmonic'), &
    explanation_type('motor', 'coefficients', 'law:polynomial', &
                  'The factor or setpoint is c0 + c1 t + c2 t^2 + ..., with the time t in seconds.', &
                  '0, 0.5 (grows by a half each second)'), &
    explanation_type('motor', 'mean', 'law:harmonic', &
                  'The factor or setpoint is mean + amplitude sin(angular_frequency t + phase).', '1'), &
    explanation_type('motor', 'amplitude', 'law:harmonic', &
                  'The factor or setpoint is mean + amplitude sin(angular_frequency t + phase).', '0.5'), &
    explanation_type('motor', 'angular_frequency', 'law:harmonic', &
                  'The factor or setpoint is mean + amplitude sin(angular_frequency t + phase).', &
                  '6.2832 (one swing to and fro each second)', '360 (one swing to and fro each second)'), &
    explanation_type('motor', 'phase', 'law:harmonic', &
                  'The factor or setpoint is mean + amplitude sin(angular_frequency t + phase).', &
                  '1.5708 (begins at mean + amplitude)', '90 (begins at mean + amplitude)'), &
    explanation_type('motor', 'file', 'law:table', &
                  'Name a text file that has a time and the factor or setpoint in each line, beside the data file.', &
                  'voltage.dat'), &
    explanation_type('motor', 'times', 'law:segments', &
                  'Segments begin and end at these times in seconds, which increase: three times make two segments. They '// &
                  'cover the times of the run, unless they repeat.', '0, 0.5, 1'), &
    explanation_type('motor', 'values', 'law:segments', &
                  'Give the factor or setpoint at each of the times, as many numbers as there are times.', '0, 1, 1'), &
    explanation_type('motor', 'laws', 'law:segments', &
                  'Each segment goes from its first value to its last by a motion law of cam design, and by dwell where both '// &
                  'values are the same. One law serves for all segments.', 'cycloidal, dwell (two segments)'), &
    explanation_type('motor', 'period', 'law:segments', &
                  'With a period the segments repeat. It is the time from the first to the last of the times.', '1')]

  type(explanation_type), parameter :: cam_texts(*) = [ &
    explanation_type('cam', 'link', '', &
                  'A cam is a link whose shape moves another link, its follower, as the drives say. The option --cam computes '// &
                  'this shape. Name the link by its number. Enter goes on without a further cam.', '2'), &
    explanation_type('cam', 'follower', '', &
                  'Name the link that touches the cam. It is guided by a pair of its own, and moved by drives.', '3'), &
    explanation_type('cam', 'point', '', &
                  'Give the centre of the roller, or any point of the flat face, in the system of the follower.', &
                  '0, 0.05, 0'), &
    explanation_type('cam', 'roller', '', &
                  'The follower touches the cam with a roller of this radius. With 0 it touches with an edge.', '0.01'), &
    explanation_type('cam', 'face', '', &
                  'A flat face can touch the cam in place of a roller. Give the direction across the face towards the cam, in '// &
                  'the system of the follower.', '0, -1, 0 (the face looks down on the cam)'), &
    explanation_type('cam', 'side', '', &
                  'The cam lies inside of the path of its roller as a disk does, or outside as a ring or the outer wall of a '// &
                  'groove does.', 'outer'), &
    explanation_type('cam', 'axis', '', &
                  'The profile lies in a plane. Give the direction across this plane, in the system of the cam, if the cam '// &
                  'does not turn about it.', '0, 0, 1'), &
    explanation_type('cam', 'guide', '', &
                  'The pressure angle is the angle between the force of the cam and the motion that a pair of the follower '// &
                  'allows. Name this pair by its coordinate where the follower has several.', '2')]

  type(explanation_type), parameter :: run_texts(*) = [ &
    explanation_type('time', 'start', '', &
                  'The first result is given at this time.', '0'), &
    explanation_type('time', 'end', '', &
                  'The last result is given at this time. A motion can also run backwards, to an earlier time than it '// &
                  'starts at.', '2.5'), &
    explanation_type('time', 'intervals', '', &
                  'The time from start to end is divided into this number of equal steps, with a result at the end of '// &
                  'each; 0 gives the start alone.', '200 (201 results)'), &
    explanation_type('solver', 'method', '', &
                  'The method integrates the equations of motion; auto serves nearly always: it makes the steps of '// &
                  'prince-dormand, of order 8, and those of bdf while very stiff springs or dampers would hold them down.', &
                  'bdf'), &
    explanation_type('solver', 'accuracy', '', &
                  'At each result, no coordinate and no point may be wrong by more than this, in rad and in m. The program '// &
                  'runs the motion several times, finds the tolerances by which this is so, and tells the error of each '// &
                  'result in the column error. 0 leaves all to the tolerances.', '1e-8'), &
    explanation_type('solver', 'relative_tolerance', '', &
                  'In each step the error may be this part of the coordinates and of their rates. A smaller number is '// &
                  'more accurate and takes longer.', '1e-10'), &
    explanation_type('solver', 'absolute_tolerance', '', &
                  'In each step the error may be this much, in rad, in m and in their rates, also where a coordinate is '// &
                  'nearly 0.', '1e-12'), &
    explanation_type('solver', 'maximum_steps', '', &
                  'The run ends with a message if it needs more steps than this from one result to the next.', '10000'), &
    explanation_type('output', 'table', '', &
                  'The results are written to this file, as a table in plain text with a line for each time.', 'crank.dat'), &
    explanation_type('output', 'hdf5', '', &
                  'The results are also written to this file in HDF5, which Python, MATLAB and other programs read.', &
                  'crank.h5'), &
    explanation_type('output', 'sketch', '', &
                  'The mechanism in its first position is drawn to this file, which any browser shows.', 'crank.svg'), &
    explanation_type('output', 'animation', '', &
                  'The moving mechanism is shown by this file. One that ends with .html is a page with buttons for a '// &
                  'browser; .svg and .gif are pictures that repeat the motion.', 'crank.html'), &
    explanation_type('output', 'view', '', &
                  'This is the direction from which the drawings are seen: two letters are the axes to the right and up, '// &
                  'iso is a view at an angle, and three numbers point to the viewer.', 'xz'), &
    explanation_type('output', 'poses', '', &
                  'The HDF5 file then holds the position and the rotation of every link too, and a file that ends with '// &
                  '.xdmf beside it shows the links in ParaView.', 'yes'), &
    explanation_type('output', 'compression', '', &
                  'The HDF5 file is compressed by this much: 0 is not at all and the fastest, 9 gives the smallest file '// &
                  'and is the slowest.', '4'), &
    explanation_type('output', 'conditioning', '', &
                  'The results then have a column that falls to 0 where the mechanism comes to a singular position.', 'yes'), &
    explanation_type('output', 'coordinates', '', &
                  'Only these coordinates are recorded; chains that nothing recorded depends on are not solved, which '// &
                  'saves time.', '5, 7'), &
    explanation_type('output', 'derivatives', '', &
                  'With 0 the results hold positions alone, with 1 velocities too, with 2 accelerations too.', '0'), &
    explanation_type('output', 'energies', '', &
                  'The results hold the kinetic energy, the potential energy and their sum, which stays the same where '// &
                  'no load takes or gives energy.', 'no'), &
    explanation_type('output', 'reactions', '', &
                  'The results then hold the force and the moment that pass through each pair, for bearings and links that '// &
                  'must bear them. Masses, gravity and loads count in mech9k, too.', 'yes'), &
    explanation_type('output', 'reaction_pairs', '', &
                  'The forces and moments of these pairs alone are recorded.', '1, 4'), &
    explanation_type('output', 'drive_forces', '', &
                  'The results then hold the force, or the torque, that each drive needs: what a motor must give.', 'yes'), &
    explanation_type('output', 'force_arrows', '', &
                  'Drawing and film then show the forces in the pairs as arrows; the longest arrow is the largest force.', 'yes'), &
    explanation_type('user', 'parameters', '', &
                  'Every user procedure of yours receives these numbers, so that they can be changed without linking it '// &
                  'again.', '0.1, 2.0')]

  type(explanation_type), parameter :: explanations(*) = &
    [general_texts, pair_texts, coupling_texts, motion_texts, body_texts, load_texts, motor_texts, cam_texts, run_texts]

contains

  !> The number of the explanation of a name; 0 if there is none.
  pure integer function find_explanation(group, name, kinds) result(place)
    character(len=*), intent(in) :: group  !< group of the name
    character(len=*), intent(in) :: name   !< the name, without a subscript
    character(len=*), intent(in) :: kinds  !< kinds of the row of the table of names that is meant

    do place = size(explanations), 1, -1
      if (explanations(place)%group == group .and. explanations(place)%name == name .and. &
          explanations(place)%kinds == kinds) return
    end do
  end function find_explanation
end module mech9_explanations
