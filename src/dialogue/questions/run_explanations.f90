!> The explanations of the names that concern cams, parameters, times, the integration and the results.
module mech9_run_explanations
  use mech9_name_explanation, only: explanation_type
  implicit none
  private
  public :: cam_texts, study_texts, long_term_texts, run_texts

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

  type(explanation_type), parameter :: study_texts(*) = [ &
    explanation_type('parameter', 'name', '', &
                  'A parameter gives one name to numbers of this file that change together, such as the length of a bar and '// &
                  'the place of its mass centre. Results call it by this name, and --set parameter(1).value changes it. '// &
                  'Enter goes on without a further parameter.', 'crank'), &
    explanation_type('parameter', 'sets', '', &
                  'Name each number as --set does: the group, its place among the groups of this name where there are several, '// &
                  'the name in it, and the place of the number in a list.', 'pair(2).point(1), body(1).centre(1)'), &
    explanation_type('parameter', 'formula', '', &
                  'A parameter can follow from others, which its formula names. It then has no value of its own.', &
                  'sqrt(a^2 + b^2)'), &
    explanation_type('parameter', 'factors', '', &
                  'A number can be a multiple of the parameter: the mass centre of a bar lies at half its length.', '1, 0.5'), &
    explanation_type('parameter', 'terms', '', &
                  'A number can be the parameter and something more, which does not change.', '0, 0.02'), &
    explanation_type('parameter', 'value', '', &
                  'The numbers follow from this value. Where the parameter sets one number only, no value is needed, and the '// &
                  'number stands as it is written.', '0.3'), &
    explanation_type('parameter', 'low', '', &
                  'Studies and optimisations go no further down than this.', '0.25'), &
    explanation_type('parameter', 'high', '', &
                  'Studies and optimisations go no further up than this.', '0.35'), &
    explanation_type('parameter', 'count', '', &
                  'A study on a grid takes so many values from the least to the largest, both included.', '11'), &
    explanation_type('parameter', 'spread', '', &
                  'A study of tolerances draws values about the given one that scatter by so much: the standard deviation, or '// &
                  'half the width where all values are equally likely.', '0.001'), &
    explanation_type('parameter', 'distribution', '', &
                  'Errors of many small causes are normal; uniform means equally likely within the spread.', 'uniform'), &
    explanation_type('quantity', 'name', '', &
                  'A quantity is one number from the whole run, which stands in the report and is compared in studies. '// &
                  'Enter goes on without a further quantity.', 'stroke'), &
    explanation_type('quantity', 'of', '', &
                  'Name a column by its heading in the table of results: q4 and dq4 belong to coordinate 4, P.x and P.vx to '// &
                  'the point P, R4.fx and F1 to forces, if these are recorded.', 'P.x'), &
    explanation_type('quantity', 'take', '', &
                  'It is the value at start, end or a time (at), the least or largest one, the largest magnitude (peak), max '// &
                  '- min (range), or the mean, the root mean square (rms) or the integral over time.', 'range'), &
    explanation_type('quantity', 'at', '', &
                  'The value at this time is taken; it need not be a time of the results.', '0.5'), &
    explanation_type('study', 'kind', '', &
                  'With the option --study the program makes a run for each of many sets of parameter values: all combinations '// &
                  'of a grid, those of a list, or sets that are drawn.', 'grid'), &
    explanation_type('study', 'runs', 'random latin sobol', &
                  'So many sets of values are drawn. Means become exact with the root of this number.', '1000'), &
    explanation_type('study', 'seed', 'random latin sobol', &
                  'The same seed draws the same values, on any machine and in any order. Another one draws others.', '2'), &
    explanation_type('study', 'carry', 'grid list', &
                  'Each run can begin where the one before ended, as when a knob is turned slowly: forwards in the order of '// &
                  'the values, backwards, or both. With a section this makes a bifurcation diagram.', 'both'), &
    explanation_type('study', 'classes', '', &
                  'Runs can be told apart by what their motions go to, a position of rest or a periodic motion: a column of '// &
                  'the study has its number.', 'yes'), &
    explanation_type('study', 'exponents', '', &
                  'Each run can have its largest Lyapunov exponents, so many of them. Over a parameter they tell where motions '// &
                  'are chaotic, over starts how well they are known.', '1'), &
    explanation_type('study', 'file', 'list', &
                  'Each line of this file has the values of all parameters, in the order of the parameters.', 'designs.dat'), &
    explanation_type('objective', 'kind', '', &
                  'With the option --optimize the program finds the values of the parameters, between their low and high, with '// &
                  'which a point follows a path, a coordinate a function, a link poses, or a quantity a value, as well as '// &
                  'possible.', 'path'), &
    explanation_type('objective', 'point', 'path', &
                  'The point must be one of the groups &point. Its distances from the targets are made small.', 'P'), &
    explanation_type('objective', 'link', 'pose', &
                  'The link goes through the poses: its origin comes near the places, and its axes near the directions.', '3'), &
    explanation_type('objective', 'of', 'function', &
                  'The coordinate follows the function: q6 is coordinate 6.', 'q6'), &
    explanation_type('objective', 'of', 'quantity', &
                  'The quantity must be one of the groups &quantity.', 'stroke'), &
    explanation_type('objective', 'over', 'function', &
                  'The function is one of time, t, or of a coordinate with a drive, such as q5.', 'q5'), &
    explanation_type('objective', 'file', 'path function', &
                  'Each line of this file is a target. For a path it holds x and y, or x, y and z, in m; with given times '// &
                  'the time stands before them. For a function it holds the variable and the value.', 'path.dat'), &
    explanation_type('objective', 'file', 'pose', &
                  'Each line of this file is a pose: x, y and an angle, or x, y, z and a rotation vector, whose length is the '// &
                  'angle. With given times the time stands before them.', 'poses.dat'), &
    explanation_type('objective', 'timing', 'path pose', &
                  'With free the targets are met one after the other at times that the search finds; with given each is met '// &
                  'at the time in its line.', 'free'), &
    explanation_type('objective', 'length', 'pose', &
                  'Distances and angles are added. An angle of 1 rad counts as much as a distance of this length.', '0.1'), &
    explanation_type('objective', 'goal', 'quantity', &
                  'The difference of the quantity from this value is made small. Without it the quantity is made least or '// &
                  'largest.', '0.3'), &
    explanation_type('objective', 'make', 'quantity', &
                  'The quantity itself is made as small as possible, or as large, where it has no goal.', 'least'), &
    explanation_type('objective', 'weight', '', &
                  'Where there are several objectives, they are added with these factors.', '10'), &
    explanation_type('limit', 'kind', '', &
                  'A design that breaks a limit is never the result. Limits are ranges of quantities, assembly through the '// &
                  'whole run, drives that can turn fully, and transmission angles.', 'quantity'), &
    explanation_type('limit', 'of', 'quantity', &
                  'The quantity must be one of the groups &quantity.', 'stroke'), &
    explanation_type('limit', 'low', 'quantity', &
                  'The quantity must not be smaller.', '0.1'), &
    explanation_type('limit', 'high', 'quantity', &
                  'The quantity must not be larger.', '0.4'), &
    explanation_type('limit', 'coordinate', 'crank', &
                  'From its value at the start this angle must be able to turn fully, while all other drives stand still.', '1'), &
    explanation_type('limit', 'coordinate', 'transmission', &
                  'At the pair of this coordinate the transmission angle is measured, for instance between coupler and rocker.', &
                  '3'), &
    explanation_type('limit', 'at_least', 'transmission', &
                  'The transmission angle must not be smaller at any time of the run. Some 40 degrees are usual.', '0.7'), &
    explanation_type('optimum', 'starts', '', &
                  'Each start leads to the best design near it. More starts find the best one of all more surely.', '1000'), &
    explanation_type('optimum', 'seed', '', &
                  'The same seed gives the same starts. Another one gives others.', '2'), &
    explanation_type('optimum', 'method', '', &
                  'The method of Levenberg and Marquardt is for sums of squares without limits; the others come from the '// &
                  'library NLopt.', 'auto')]

  type(explanation_type), parameter :: long_term_texts(*) = [ &
    explanation_type('section', 'coordinate', '', &
                  'The section has a point whenever the coordinate with this number passes a value. Leave it out where a '// &
                  'column or a period gives the points.', '2'), &
    explanation_type('section', 'column', '', &
                  'In place of a coordinate, a column of the results may pass the value. Name it by its heading.', 'P.vy'), &
    explanation_type('section', 'period', '', &
                  'In place of a value, the motion may have a point after each period, such as that of a drive.', &
                  '9.42477796076938'), &
    explanation_type('section', 'value', '', &
                  'The coordinate or the column passes this value at each point.', '0'), &
    explanation_type('section', 'direction', '', &
                  'With 1 the points are those at which the value grows with time, with -1 those at which it falls, with 0 '// &
                  'both.', '-1'), &
    explanation_type('section', 'every_turn', '', &
                  'A coordinate that goes on turning passes the same place once in each turn. With .true. each of them counts.', &
                  '.true.'), &
    explanation_type('section', 'transient', '', &
                  'Points before this time, counted from the start of the motion, are left out.', '100'), &
    explanation_type('section', 'table', '', &
                  'The points are written into this file, with the columns of the results.', 'section.dat'), &
    explanation_type('section', 'reduce_angles', '', &
                  'With .true. plots of the section show all angles within one turn. Tables keep the turns.', '.true.'), &
    explanation_type('exponents', 'transient', '', &
                  'Before this time, counted from the start of the motion, nothing is summed. The motion comes to its '// &
                  'long-term behaviour meanwhile.', '100'), &
    explanation_type('exponents', 'time', '', &
                  'The exponents are means over this time. Errors fall with its square root.', '1000'), &
    explanation_type('periodic', 'period', '', &
                  'The motion is the same after this time. It is a multiple of the period of drives, loads and motors. Where '// &
                  'none of them follows the time, give a guess.', '9.42477796076938'), &
    explanation_type('periodic', 'starts', '', &
                  'The search begins at the start of this file. From random starts it may find other periodic motions.', '20'), &
    explanation_type('branch', 'parameter', '', &
                  'The branches show positions of rest over the parameter with this name.', 'force'), &
    explanation_type('branch', 'of', '', &
                  'Positions of rest are the usual ones. Where all independent coordinates have drives, branches show '// &
                  'positions in which these stand still.', 'equilibrium'), &
    explanation_type('branch', 'low', '', &
                  'Branches end at this value of the parameter.', '0'), &
    explanation_type('branch', 'high', '', &
                  'Branches end at this value of the parameter, too.', '20'), &
    explanation_type('branch', 'step', '', &
                  'Steps along a branch are no longer. Shorter ones give smoother pictures.', '0.02'), &
    explanation_type('branch', 'points', '', &
                  'A branch ends after this number of points in each of its two directions.', '200'), &
    explanation_type('branch', 'switch', '', &
                  'With .false. branches that cross at branch points are left out.', '.false.')]

  type(explanation_type), parameter :: run_texts(*) = [ &
    explanation_type('time', 'start', '', &
                  'The first result is given at this time.', '0'), &
    explanation_type('time', 'end', '', &
                  'The last result is given at this time. A motion can also run backwards, to an earlier time than it '// &
                  'starts at.', '2.5'), &
    explanation_type('time', 'intervals', '', &
                  'The time from start to end is divided into this number of equal steps, with a result at the end of '// &
                  'each; 0 gives the start alone.', '200 (201 results)'), &
    explanation_type('time', 'at', '', &
                  'There is then one result, at this time, as homework asks for it; start, end and intervals do not '// &
                  'count.', '0.3'), &
    explanation_type('solver', 'method', '', &
                  'The method integrates the equations of motion; auto serves nearly always: it makes the steps of '// &
                  'prince-dormand, of order 8, and those of bdf while very stiff springs or dampers would hold them down.', &
                  'bdf'), &
    explanation_type('solver', 'accuracy', '', &
                  'At each result, no coordinate and no point may be wrong by more than this, in units of the file. The '// &
                  'program runs the motion several times, finds the tolerances by which this is so, and tells the error of '// &
                  'each result in the column error. 0 leaves all to the tolerances.', '1e-8'), &
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
                  'browser; .svg and .gif are pictures that repeat the motion, and .mp4 is a video.', 'crank.html'), &
    explanation_type('output', 'view', '', &
                  'This is the direction from which the drawings are seen: two letters are the axes to the right and up, '// &
                  'iso is a view at an angle, and three numbers point to the viewer.', 'xz'), &
    explanation_type('output', 'poses', '', &
                  'The HDF5 file then holds the position and the rotation of every link too, and a file that ends with '// &
                  '.xdmf beside it shows the links in ParaView.', 'yes'), &
    explanation_type('output', 'hdf5_runs', '', &
                  'The HDF5 file of a study then holds the whole motion of each run, and not its quantities alone.', 'yes'), &
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
                  'Drawing and film then show the forces and moments in the pairs, the loads, the weights, and the forces of '// &
                  'stops, friction and contacts as arrows; the longest arrow is the largest force.', 'yes'), &
    explanation_type('output', 'velocity_arrows', '', &
                  'Drawing and film then show the velocity of each point as an arrow; the longest arrow is the largest '// &
                  'velocity.', 'yes'), &
    explanation_type('output', 'acceleration_arrows', '', &
                  'Drawing and film then show the acceleration of each point as an arrow; the longest arrow is the largest '// &
                  'acceleration.', 'yes'), &
    explanation_type('output', 'links', '', &
                  'The results then tell how these links turn: in a plane by an angle, its rate and its acceleration; in '// &
                  'space by four numbers of a quaternion, angular velocity and angular acceleration.', '2, 3'), &
    explanation_type('output', 'poles', '', &
                  'The results then hold the velocity poles of these links: the points about which they turn at each '// &
                  'moment.', '3'), &
    explanation_type('output', 'reaction_magnitudes', '', &
                  'The results then hold how large the force and the moment in each pair are, beside their components.', 'yes'), &
    explanation_type('output', 'reaction_axes', '', &
                  'With link, forces and moments in the pairs are given along the axes of the moving link, as for polar '// &
                  'diagrams of pins; with fixed, along those of link 1.', 'link'), &
    explanation_type('output', 'sensitivities', '', &
                  'The results then hold how each recorded number changes with each &parameter, as derivatives.', 'yes'), &
    explanation_type('output', 'gradients', '', &
                  'The report then tells how each &quantity changes with each &parameter, as derivatives.', 'yes'), &
    explanation_type('user', 'parameters', '', &
                  'Every user procedure of yours receives these numbers, so that they can be changed without linking it '// &
                  'again.', '0.1, 2.0')]
end module mech9_run_explanations
