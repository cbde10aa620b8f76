!> The explanations of the names that concern pairs and joints with several freedoms.
module mech9_pair_explanations
  use mech9_name_explanation, only: explanation_type
  implicit none
  private
  public :: pair_texts

  type(explanation_type), parameter :: pair_texts(*) = [ &
    explanation_type('pair', 'coordinate', 'revolute prismatic helical path user', &
                  'Such a pair has one coordinate, and pair and coordinate have the same number.', '5'), &
    explanation_type('pair', 'coordinates', 'spherical', &
                  'A ball joint has three coordinates: turns about the x axis of the joint''s frame, then about its turned y '// &
                  'axis, then about its z axis that has turned twice. They have numbers as other coordinates have; the first '// &
                  'is the number of the joint.', '4, 5, 6'), &
    explanation_type('pair', 'coordinates', 'universal', &
                  'A universal joint has two coordinates: its turn about axis, which is fixed in the reference link, and '// &
                  'its turn about moving_axis, which is fixed in the moving link. The first is the number of the joint.', &
                  '4, 5'), &
    explanation_type('pair', 'coordinates', 'cylindrical', &
                  'A cylindrical joint has two coordinates: the angle by which the moving link turns about the axis, and the '// &
                  'length by which it slides along the axis. The first is the number of the joint.', '4, 5'), &
    explanation_type('pair', 'coordinates', 'planar', &
                  'A planar joint has three coordinates: the slide along the direction zero, the slide across it in the '// &
                  'plane, and the turn about the axis, which is perpendicular to it. The first is the number of the joint.', &
                  '4, 5, 6'), &
    explanation_type('pair', 'coordinates', 'free', &
                  'A link that moves freely against another one has six coordinates: slides along the x, y and z axes of the '// &
                  'joint''s frame, then turns about x, y and z. The first is the number of the joint.', '4, 5, 6, 7, 8, 9'), &
    explanation_type('pair', 'name', '', &
                  'A pair may have a name, which may stand wherever the number of its coordinate does. Results can call its '// &
                  'columns by it.', 'B'), &
    explanation_type('link', 'number', '', &
                  'A link may have a name. Tell which link by its number. Enter goes on without a further name.', '2'), &
    explanation_type('link', 'name', '', &
                  'The name may stand wherever the number of the link does.', 'crank'), &
    explanation_type('pair', 'links', '', &
                  'Name the two links that the pair joins by their numbers. The first is the reference link, in whose '// &
                  'system the pair is described; the second is the moving link. A positive coordinate moves the second '// &
                  'against the first.', '1-2 (the same as 1, 2: link 2 moves against the frame)'), &
    explanation_type('pair', 'kind', '', &
                  'Revolute is a hinge, prismatic a slide, helical a screw; path leads a link along a curve, and user is a '// &
                  'procedure of yours. Joints with several freedoms: spherical is a ball joint, universal has two crossing '// &
                  'axes; cylindrical, planar and free. The first letters will do.', 'rev'), &
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
    explanation_type('pair', 'point', 'spherical universal cylindrical planar free', &
                  'Give the centre of a ball or universal joint, any point of the axis of a cylindrical joint or of the '// &
                  'plane of a planar joint, or the origin of a free one, by its coordinates in the reference link.', &
                  '0.3, 0, 0 (0.3 m from the origin along x)'), &
    explanation_type('pair', 'axis', 'universal cylindrical planar', &
                  'Give the first axis of a universal joint, the axis of a cylindrical joint, or the direction perpendicular '// &
                  'to the plane of a planar joint, by components in the reference link. Its length does not matter. The '// &
                  'letters x, y, z and -x, -y, -z will do.', 'z (the same as 0, 0, 1)'), &
    explanation_type('pair', 'axis', 'spherical free', &
                  'The coordinates are counted in a frame of the joint. Its z axis has this direction in the reference link. '// &
                  'A frame parallel to the reference link is mostly right.', 'x'), &
    explanation_type('pair', 'zero', 'spherical cylindrical planar free', &
                  'The x axis of the joint''s frame has this direction in the reference link; it is made perpendicular to '// &
                  'axis. The first slide of a planar joint goes along it.', 'x'), &
    explanation_type('pair', 'moving_point', 'spherical universal cylindrical planar free', &
                  'Give the same point by its coordinates in the moving link. It is needed only where the systems of the two '// &
                  'links do not coincide when the coordinates are 0.', '0, 0, 0 (the moving link has its origin in the joint)'), &
    explanation_type('pair', 'moving_axis', 'universal', &
                  'Give the second axis of the universal joint by components in the moving link. It must not be parallel to '// &
                  'the first axis, and is mostly perpendicular to it. The systems of both links are parallel when both '// &
                  'coordinates are 0.', 'y (the same as 0, 1, 0)'), &
    explanation_type('pair', 'moving_axis', 'spherical cylindrical planar free', &
                  'Give the direction of the z axis of the joint''s frame by components in the moving link. It is needed '// &
                  'only where the systems of the two links do not coincide when the coordinates are 0.', 'z'), &
    explanation_type('pair', 'moving_zero', 'spherical cylindrical planar free', &
                  'This direction of the moving link points along the direction zero of the reference link when the '// &
                  'coordinates are 0.', 'x'), &
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
    explanation_type('pair', 'scale', 'path', &
                  'All coordinates in the file are multiplied by this number: for a file in other units, or a curve in another '// &
                  'size.', &
                  '0.001 (from millimetres to metres)'), &
    explanation_type('pair', 'orientation', 'path', &
                  'The moving link can keep its orientation while one of its points follows the curve, or turn with the '// &
                  'tangent of the curve, as a train does on its rails.', 'tangent'), &
    explanation_type('pair', 'closed', 'path', &
                  'A closed curve repeats: the coordinate, a length along it, may grow beyond its length. The file says it '// &
                  'by its last point, which is the first one again; this name is for those that are to be read otherwise.', &
                  '.false.'), &
    explanation_type('pair', 'point', 'path', &
                  'This is the origin of the coordinates in the file of the curve, given in the reference link.', '0, 0.2, 0'), &
    explanation_type('pair', 'axis', 'path', &
                  'This direction of the reference link is the z axis of the coordinates in the file of the curve. The '// &
                  'letters x, y, z and -x, -y, -z will do.', 'z'), &
    explanation_type('pair', 'zero', 'path', &
                  'This direction of the reference link is the x axis of the coordinates in the file of the curve; it is '// &
                  'made perpendicular to axis.', 'x'), &
    explanation_type('pair', 'moving_point', 'path', &
                  'This point of the moving link follows the curve.', '0.1, 0, 0'), &
    explanation_type('pair', 'moving_axis', 'path', &
                  'This direction of the moving link stays along axis where the link keeps its orientation or the '// &
                  'curve lies in a plane; else it stays across the tangent.', 'z'), &
    explanation_type('pair', 'moving_zero', 'path', &
                  'This direction of the moving link stays along zero, or along the tangent where the link turns with the '// &
                  'curve.', 'x')]
end module mech9_pair_explanations
