!> The explanations of the names that concern the mechanism, its structure, couplings, points and motion.
module mech9_mechanism_explanations
  use mech9_name_explanation, only: explanation_type
  implicit none
  private
  public :: general_texts, coupling_texts, motion_texts

  type(explanation_type), parameter :: general_texts(*) = [ &
    explanation_type('mechanism', 'title', '', &
                  'The title heads the table of results, the plots and the drawings, and the names of files are made '// &
                  'from it.', 'Crank with two slides'), &
    explanation_type('mechanism', 'links', '', &
                  'Count every rigid part, and the frame too: the frame is link 1, and the others have the numbers 2, 3 '// &
                  'and so on in any order.', '4 (a four-bar linkage: frame, crank, coupler and rocker)'), &
    explanation_type('mechanism', 'coordinates', '', &
                  'Most pairs have one coordinate, an angle or a length; joints with several freedoms have as many '// &
                  'coordinates: a ball joint has three, a universal joint two. Give the number of all coordinates '// &
                  'together.', &
                  '4 (a four-bar linkage has four hinges)'), &
    explanation_type('mechanism', 'angle_unit', '', &
                  'All angles that you type and all angles in the results are in this unit, and their rates in this unit '// &
                  'per second.', 'deg'), &
    explanation_type('mechanism', 'length_unit', '', &
                  'All lengths that you type and all lengths in the results are in this unit. Answers in other units are '// &
                  'converted: 80 mm, 2.5 in.', 'mm'), &
    explanation_type('mechanism', 'force_unit', '', &
                  'All forces are in this unit. Torques and energies are in this unit times the unit of lengths.', 'kN'), &
    explanation_type('mechanism', 'mass_unit', '', &
                  'All masses are in this unit. Moments of inertia are in this unit times the square of the unit of '// &
                  'lengths.', 't'), &
    explanation_type('mechanism', 'rate_unit', '', &
                  'Rates of angles are in this unit: velocities at the start, angular frequencies, the second coefficient '// &
                  'of a drive, and the columns dq of the results.', 'rpm'), &
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

  type(explanation_type), parameter :: coupling_texts(*) = [ &
    explanation_type('coupling', 'kind', '', &
                  'A gear or a belt couples two coordinates that turn, a rack or a screw one that turns and one that slides. '// &
                  'linear couples any coordinates by a sum, table two of them by a function from a file, user by a procedure '// &
                  'of yours. Enter goes on without a further coupling.', 'gear'), &
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
    explanation_type('coupling', 'file', 'table', &
                  'Each line of the file has a value of the first coordinate and one of the second. A table over one full '// &
                  'turn of the first repeats; any other ends the motion at its ends.', 'cam.dat (with lines such as: 90 0.012)'), &
    explanation_type('coupling', 'coefficients', 'linear', &
                  'The sum of these numbers, each times its coordinate, is constant. Give one for each coordinate.', '1, -2, 1'), &
    explanation_type('coupling', 'constant', 'linear', &
                  'The sum of the coefficients times the coordinates has this value.', '0')]

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
end module mech9_mechanism_explanations
