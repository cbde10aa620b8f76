!> The names of &output: where results go, and which there are.
module mech9_output_grammar
  use mech9_program_kind, only: dynamics
  use mech9_grammar_rows, only: item_row_type, unlimited, optional
  implicit none
  private
  public :: output_items

  type(item_row_type), parameter :: output_items(*) = [ &
    item_row_type('output', 'table', 'text', 1, 1, '', optional, '''''', '', '', '', &
                  'file for the table of results', '''fig1.dat'''), &
    item_row_type('output', 'hdf5', 'text', 1, 1, '', optional, '''''', '', '', '', &
                  'HDF5 file for the results', '''fig1.h5''', seldom=.true.), &
    item_row_type('output', 'sketch', 'text', 1, 1, '', optional, '''''', '', '', '', &
                  'SVG file for a drawing of the mechanism at the start', '''fig1.svg''', seldom=.true.), &
    item_row_type('output', 'animation', 'text', 1, 1, '', optional, '''''', '', '', '', &
                  'file for the moving mechanism: .html is a page that plays it, .svg and .gif repeat it, .mp4 is a video', &
                  '''fig1.html''', seldom=.true.), &
    item_row_type('output', 'view', 'text', 1, 1, '', optional, '''''', '', '', '', &
                  'axes of both pictures to the right and up, as in xz; iso; or the direction to the viewer, as in 1,-2,1', &
                  '''xz''', seldom=.true.), &
    item_row_type('output', 'poses', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'the HDF5 file holds the poses of all links too, and an .xdmf file beside it shows them in ParaView', '.true.', &
                  seldom=.true.), &
    item_row_type('output', 'hdf5_runs', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'the HDF5 file of a study holds all columns of all its runs too, over the runs and time', '.true.', &
                  seldom=.true.), &
    item_row_type('output', 'compression', 'integer', 1, 1, '', optional, '0', '>=0', '', '', &
                  'compression of the HDF5 file: from 0, none (the fastest), to 9 (the smallest)', '4', seldom=.true.), &
    item_row_type('output', 'conditioning', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'a column with the least singular value of the worst chains (rad, lengths of the mechanism)', &
                  '.true.', seldom=.true.), &
    item_row_type('output', 'coordinates', 'integer', 1, unlimited, '', optional, '(all)', '>=1', '', '', &
                  'coordinates that are recorded; chains on which no recorded quantity depends are not solved', '5, 7', &
                  seldom=.true.), &
    item_row_type('output', 'derivatives', 'integer', 1, 1, '', optional, '2', '>=0', '', '', &
                  'highest recorded derivative: 0 positions, 1 velocities too, 2 accelerations too', '0', seldom=.true.), &
    item_row_type('output', 'energies', 'logical', 1, 1, '', optional, '.true.', '', '', '', &
                  'whether mech9d records kinetic and potential energy and their sum', '.false.', seldom=.true., &
                  program=dynamics), &
    item_row_type('output', 'reactions', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'forces and moments in the pairs, for which bodies, gravity and loads count in mech9k too', '.true.', &
                  seldom=.true.), &
    item_row_type('output', 'reaction_pairs', 'integer', 1, unlimited, '', optional, '(all)', '>=1', '', '', &
                  'pairs whose forces and moments are recorded, by the numbers of their coordinates', '1, 4', seldom=.true.), &
    item_row_type('output', 'drive_forces', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'the force or torque that each drive needs for its motion', '.true.', seldom=.true.), &
    item_row_type('output', 'sensitivities', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'derivatives of recorded coordinates, points, forces, motors and energies by each parameter', '.true.', &
                  seldom=.true.), &
    item_row_type('output', 'gradients', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'derivatives of the quantities by each parameter, without columns of their own', '.true.', seldom=.true.), &
    item_row_type('output', 'force_arrows', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'arrows of forces and moments in pairs, loads, weights, stops, friction and contacts in both pictures', &
                  '.true.', seldom=.true.), &
    item_row_type('output', 'velocity_arrows', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'arrows of the velocities of the points in both pictures, the longest for the largest velocity', '.true.', &
                  seldom=.true.), &
    item_row_type('output', 'acceleration_arrows', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'arrows of the accelerations of the points in both pictures, the longest for the largest one', '.true.', &
                  seldom=.true.), &
    item_row_type('output', 'links', 'integer', 1, unlimited, '', optional, '(none)', '>=1', '', '', &
                  'links whose turning is recorded: in a plane angle, angular velocity and acceleration, in space quaternions', &
                  '2, 3', seldom=.true.), &
    item_row_type('output', 'poles', 'integer', 1, unlimited, '', optional, '(none)', '>=1', '', '', &
                  'links of a planar mechanism whose velocity poles against link 1 are recorded', '3', seldom=.true.), &
    item_row_type('output', 'reaction_magnitudes', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'magnitudes of force and moment beside the components in the pairs', '.true.', seldom=.true.), &
    item_row_type('output', 'reaction_axes', 'text', 1, 1, '', optional, '''fixed''', '', 'fixed link', '', &
                  'axes of forces and moments in the pairs: fixed, those of link 1; link, those of the moving link', &
                  '''link''', seldom=.true.)]
end module mech9_output_grammar
