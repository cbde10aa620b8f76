!> The explanations of the names that concern bodies, gravity, loads and motors.
module mech9_force_explanations
  use mech9_name_explanation, only: explanation_type
  implicit none
  private
  public :: body_texts, load_texts, motor_texts, stop_texts, friction_texts, contact_texts

  character(len=*), parameter :: any_law = 'law:polynomial law:harmonic law:table law:segments'

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
                  '-y (9.81 m/s^2 against y, which points up)')]

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
                  'The spring pulls with this force for each unit of length by which it is longer than its free '// &
                  'length. A damper alone has stiffness 0.', '200 (2 N for each centimetre)'), &
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
                  'The damper pulls with this force for each unit of speed at which the distance of its ends grows.', '1.5'), &
    explanation_type('load', 'damping', 'coordinate', &
                  'The load is -stiffness (q - rest) - damping dq/dt + force. The damping of an angle is per rad/s, '// &
                  'whatever angle_unit says.', '0.1 (0.1 N m for each rad/s)', '0.1 (0.1 N m for each rad/s)', &
                  '1.5 (1.5 N for each m/s)'), &
    explanation_type('load', 'law', 'force torque spring coordinate', &
                  'The load is multiplied by a number that depends on time as a drive does: constant, polynomial, harmonic, '// &
                  'table or segments.', 'harmonic'), &
    explanation_type('load', 'over', any_law, &
                  'The law may have another variable than the time: a coordinate (q1), its rate (dq1), or the position or '// &
                  'velocity of a point (P.x, P.vx). Spring curves, and forces over a crank angle, are such loads.', &
                  'q1 (the law counts in coordinate 1)'), &
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
                  'Name a text file that has a time, or the value of the variable, and the factor in each line, beside the '// &
                  'data file.', 'force.dat'), &
    explanation_type('load', 'times', 'law:segments', &
                  'Segments begin and end at these times in seconds, which increase: three times make two segments. They '// &
                  'cover the times of the run, unless they repeat.', '0, 0.5, 1'), &
    explanation_type('load', 'values', 'law:segments', &
                  'Give the factor at each of the times, as many numbers as there are times.', '0, 1, 1'), &
    explanation_type('load', 'laws', 'law:segments', &
                  'Each segment goes from its first value to its last by a motion law of cam design, and by dwell where both '// &
                  'values are the same. One law serves for all segments.', 'cycloidal, dwell (two segments)'), &
    explanation_type('load', 'period', 'law:segments law:table', &
                  'With a period the segments or the table repeat. It is the time from the first to the last of the times.', '1')]

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
    explanation_type('motor', 'over', any_law, &
                  'The law may have another variable than the time: a coordinate (q1), its rate (dq1), or the position or '// &
                  'velocity of a point (P.x, P.vx).', &
                  'dq1 (the law counts in the rate of coordinate 1)'), &
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
    explanation_type('motor', 'period', 'law:segments law:table', &
                  'With a period the segments or the table repeat. It is the time from the first to the last of the times.', '1')]

  type(explanation_type), parameter :: stop_texts(*) = [ &
    explanation_type('stop', 'coordinate', '', &
                  'A stop bounds any coordinate, independent or not. Name it by its number. Enter goes on without a further '// &
                  'stop.', '4'), &
    explanation_type('stop', 'low', '', &
                  'The coordinate comes no lower than this. Enter: the stop has no low end.', '0 (no lower than 0)'), &
    explanation_type('stop', 'high', '', &
                  'The coordinate comes no higher than this. Enter: the stop has no high end.', '0.1 (no higher than 0.1)'), &
    explanation_type('stop', 'restitution', '', &
                  'After an impact the coordinate goes back with this part of its rate: 0 stops it, 1 loses no energy.', '0.6'), &
    explanation_type('stop', 'stiffness', '', &
                  'A stop with a stiffness gives way instead of being hit: its force grows with the penetration.', &
                  '1e5 (1e5 N for each m)', '1e3 (1e3 N m for each rad)', '1e5 (1e5 N for each m)'), &
    explanation_type('stop', 'damping', '', &
                  'The force of a compliant stop grows by this for each rad/s or m/s of penetration, times the penetration to '// &
                  'the power of the exponent.', '200'), &
    explanation_type('stop', 'exponent', '', &
                  'The force of a compliant stop grows with this power of the penetration: 1 for springs, 1.5 for balls.', '1.5')]

  type(explanation_type), parameter :: friction_texts(*) = [ &
    explanation_type('friction', 'coordinate', '', &
                  'Friction acts in a pair that turns, slides or does both on a thread. Name it by the number of its '// &
                  'coordinate. Enter goes on without a further friction.', '4'), &
    explanation_type('friction', 'dynamic', '', &
                  'While the pair moves, the friction is this part of the force that presses it. Steel on bronze has 0.1 to 0.2.', &
                  '0.15'), &
    explanation_type('friction', 'static', '', &
                  'At rest the friction holds up to this part of the force that presses.', '0.2'), &
    explanation_type('friction', 'radius', '', &
                  'In a turning pair the friction acts on this radius, the mean one of the thread in a helical pair.', &
                  '0.01 (a pin of 20 mm)'), &
    explanation_type('friction', 'face_radius', '', &
                  'Forces along the axis of a turning pair press on a face. This is its mean radius.', '0.015'), &
    explanation_type('friction', 'arm', '', &
                  'Moments tilt a slider in its guide, which presses at both ends. This is half the distance of the ends.', &
                  '0.05 (a guide of 100 mm)'), &
    explanation_type('friction', 'preload', '', &
                  'Springs and seals press also without a load: give a force in N, for a turning pair a torque in N m.', '5'), &
    explanation_type('friction', 'law', '', &
                  'By coulomb the pair sticks and slips. By smooth it creeps in place of sticking, for comparison with '// &
                  'other programs.', 'coulomb'), &
    explanation_type('friction', 'transition', '', &
                  'By the smooth law the friction grows up to about this rate, above which it stays.', '0.01')]

  type(explanation_type), parameter :: contact_texts(*) = [ &
    explanation_type('contact', 'point', '', &
                  'The name of a traced point that touches, or about which a ball does. Enter goes on without a further contact.', &
                  'P'), &
    explanation_type('contact', 'link', '', &
                  'The number of the link with the surface: 1 for the frame.', '1'), &
    explanation_type('contact', 'kind', '', &
                  'The surface is a plane, a sphere, or a path: a curve in a plane, and along the axis of this plane.', 'plane'), &
    explanation_type('contact', 'origin', '', &
                  'A point of the plane, the centre of the sphere, or the origin of the path, in the system of its link.', &
                  '0 0 0'), &
    explanation_type('contact', 'normal', '', &
                  'The direction from the plane to its free side, in the axes of its link.', '0 0 1 (upwards)'), &
    explanation_type('contact', 'file', '', &
                  'Name the text file with the points of a path: x and y in each line. A smooth curve goes through them. An '// &
                  'empty line makes a corner at the point before it. A closed curve has its first point again at the end.', &
                  'cam.dat (with lines such as: 0.1 0.25)'), &
    explanation_type('contact', 'columns', '', &
                  'A file of a path can have further columns. Tell in which of them x and y stand.', '3, 4'), &
    explanation_type('contact', 'scale', '', &
                  'All coordinates in the file of a path are multiplied by this number.', '0.001'), &
    explanation_type('contact', 'axis', '', &
                  'The direction across the plane of a path, in the axes of its link. The surface goes on along it.', 'z'), &
    explanation_type('contact', 'zero', '', &
                  'The direction of x in the file of a path, in the axes of its link; it is made perpendicular to axis.', 'x'), &
    explanation_type('contact', 'closed', '', &
                  'A closed path has no ends. The file says it by its last point, which is the first one again.', 'no'), &
    explanation_type('contact', 'side', '', &
                  'The ball is outside or inside of a closed path, or to the left or right of any path, seen along the curve '// &
                  'with the axis up.', 'left'), &
    explanation_type('contact', 'radius', '', &
                  'Of the ball about the point. Enter: the point itself touches.', '0.05'), &
    explanation_type('contact', 'other_radius', '', &
                  'Of the sphere that is the surface.', '0.1'), &
    explanation_type('contact', 'restitution', '', &
                  'After an impact the links part with this part of their rate: 0 lets them touch, 1 loses no energy.', '0.6'), &
    explanation_type('contact', 'friction', '', &
                  'While the contact slides, the friction is this part of the normal force. Enter: there is none.', '0.3'), &
    explanation_type('contact', 'static_friction', '', &
                  'At rest the friction holds up to this part of the normal force.', '0.4'), &
    explanation_type('contact', 'stiffness', '', &
                  'A contact with a stiffness gives way instead of being hit: its force grows with the penetration.', '1e5'), &
    explanation_type('contact', 'damping', '', &
                  'The force of a compliant contact grows by this for each m/s of penetration, times the penetration to '// &
                  'the power of the exponent.', '200'), &
    explanation_type('contact', 'exponent', '', &
                  'The force of a compliant contact grows with this power of the penetration: 1 for springs, 1.5 for balls.', &
                  '1.5')]
end module mech9_force_explanations
