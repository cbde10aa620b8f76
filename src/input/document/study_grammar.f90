!> The names of the groups for parameters, quantities, studies, objectives and the long-term motion, and for the names of links.
module mech9_study_grammar
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_grammar_rows, only: item_row_type, unlimited, needed, optional
  implicit none
  private
  public :: study_items, link_items, long_term_items

  type(item_row_type), parameter :: link_items(*) = [ &
    item_row_type('link', 'number', 'integer', 1, 1, '', needed, '', '>=1', '', '', &
                  'number of the link', '2'), &
    item_row_type('link', 'name', 'text', 1, 1, '', needed, '', '', '', '', &
                  'its name; letters, digits and _', '''crank''')]

  type(item_row_type), parameter :: study_items(*) = [ &
    item_row_type('parameter', 'name', 'text', 1, 1, '', needed, '', '', '', '', &
                  'its name in results; letters, digits and _', '''crank'''), &
    item_row_type('parameter', 'sets', 'text', 1, unlimited, '', optional, '(none)', '', '', '', &
                  'the numbers that it sets, named as in --set: number 1 of point in the second &pair, for instance', &
                  '''pair(2).point(1)'''), &
    item_row_type('parameter', 'formula', 'text', 1, 1, '', optional, '(none)', '', '', '', &
                  'its value from other parameters: + - * / ^, sqrt sin cos tan asin acos atan atan2 exp log abs min max, pi', &
                  '''sqrt(a^2 + b^2)''', seldom=.true.), &
    item_row_type('parameter', 'factors', 'real', 1, unlimited, '', optional, '1', '', '', '', &
                  'each number is its factor times the value, plus its term: a factor for each number, or one for all', '1, 0.5', &
                  seldom=.true.), &
    item_row_type('parameter', 'terms', 'real', 1, unlimited, '', optional, '0', '', '', '', &
                  'the part of each number that does not depend on the value: a term for each number, or one for all', '0, 0.1', &
                  seldom=.true.), &
    item_row_type('parameter', 'value', 'real', 1, 1, '', optional, '(from the number)', '', '', '', &
                  'its value; by default the one with which the only number that it sets stays as it is written', '0.3'), &
    item_row_type('parameter', 'low', 'real', 1, 1, '', optional, '(none)', '', '', '', &
                  'its least value in studies and optimisations', '0.2', seldom=.true.), &
    item_row_type('parameter', 'high', 'real', 1, 1, '', optional, '(none)', '', '', '', &
                  'its largest value in studies and optimisations', '0.4', seldom=.true.), &
    item_row_type('parameter', 'count', 'integer', 1, 1, '', optional, '(none)', '>=1', '', '', &
                  'how many values from low to high a grid has', '11', seldom=.true.), &
    item_row_type('parameter', 'spread', 'real', 1, 1, '', optional, '(none)', '>0', '', '', &
                  'how far it scatters about its value: standard deviation, or half the width of a uniform distribution', '0.001', &
                  seldom=.true.), &
    item_row_type('parameter', 'distribution', 'text', 1, 1, '', optional, '''normal''', '', 'normal uniform', '', &
                  'the distribution of which spread is the measure', '''uniform''', seldom=.true.), &
    item_row_type('quantity', 'name', 'text', 1, 1, '', needed, '', '', '', '', &
                  'its name in results; letters, digits and _', '''stroke'''), &
    item_row_type('quantity', 'of', 'text', 1, 1, '', needed, '', '', '', '', &
                  'the column of the results from which it is taken', '''P.x'''), &
    item_row_type('quantity', 'take', 'text', 1, 1, '', needed, '', '', 'start end min max peak range mean rms integral at', '', &
                  'which number: peak is the largest magnitude, range max - min; mean, rms and integral are over time', &
                  '''range'''), &
    item_row_type('quantity', 'at', 'real', 1, 1, 's', optional, '(none)', '', '', '', &
                  'the time of the value, for take=''at''', '0.5', seldom=.true.), &
    item_row_type('study', 'kind', 'text', 1, 1, '', needed, '', '', 'grid list random latin sobol', '', &
                  'all combinations on a grid, a list in a file, or values that are drawn: at random, latin hypercube or Sobol', &
                  '''grid'''), &
    item_row_type('study', 'runs', 'integer', 1, 1, '', needed, '', '>=1', '', 'random latin sobol', &
                  'how many sets of values are drawn', '1000'), &
    item_row_type('study', 'seed', 'integer', 1, 1, '', optional, '1', '>=0', '', 'random latin sobol', &
                  'another seed draws other values', '2', seldom=.true.), &
    item_row_type('study', 'file', 'text', 1, 1, '', needed, '', '', '', 'list', &
                  'a text file with the values of all parameters in each line, in their order, beside the data file', &
                  '''designs.dat'''), &
    item_row_type('study', 'carry', 'text', 1, 1, '', optional, '''none''', '', 'none forwards backwards both', 'grid list', &
                  'each run begins where the one before ended: in the order of the values, in the opposite order, or in both', &
                  '''both''', seldom=.true., program=dynamics), &
    item_row_type('study', 'classes', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'a column class: the number of what each motion goes to, of a position of rest or a periodic motion', '.true.', &
                  seldom=.true., program=dynamics), &
    item_row_type('study', 'exponents', 'integer', 1, 1, '', optional, '0', '>=0', '', '', &
                  'so many Lyapunov exponents of each motion, with standard errors, over the times of &exponents', '1', &
                  seldom=.true., program=dynamics), &
    item_row_type('objective', 'kind', 'text', 1, 1, '', needed, '', '', 'path function pose quantity', '', &
                  'a point follows a path, a coordinate a function, a link goes through poses, or a quantity has a value', &
                  '''path'''), &
    item_row_type('objective', 'point', 'text', 1, 1, '', needed, '', '', '', 'path', &
                  'name of the point that follows the path', '''P''', &
                  program=kinematics), &
    item_row_type('objective', 'link', 'integer', 1, 1, '', needed, '', '>=1', '', 'pose', &
                  'number of the link that goes through the poses', '3', &
                  program=kinematics), &
    item_row_type('objective', 'of', 'text', 1, 1, '', needed, '', '', '', 'function', &
                  'the coordinate that follows the function, by its heading in the results', '''q6''', &
                  program=kinematics), &
    item_row_type('objective', 'of', 'text', 1, 1, '', needed, '', '', '', 'quantity', &
                  'name of the &quantity', '''stroke'''), &
    item_row_type('objective', 'over', 'text', 1, 1, '', optional, '''t''', '', '', 'function', &
                  'the variable of the function: t, or a driven coordinate', '''q5''', &
                  program=kinematics), &
    item_row_type('objective', 'file', 'text', 1, 1, '', needed, '', '', '', 'path function', &
                  'a text file beside the data file, with a target in each line: x y [z] or t x y [z] of a path, or x and f(x)', &
                  '''path.dat''', program=kinematics), &
    item_row_type('objective', 'file', 'text', 1, 1, '', needed, '', '', '', 'pose', &
                  'a text file beside the data file, with a pose in each line: [t] x y angle, or [t] x y z and a rotation vector', &
                  '''poses.dat''', program=kinematics), &
    item_row_type('objective', 'timing', 'text', 1, 1, '', optional, '''free''', '', 'free given', 'path pose', &
                  'the targets are met at any times in their order (free), or each at the time t in its line (given)', &
                  '''given''', program=kinematics), &
    item_row_type('objective', 'length', 'real', 1, 1, 'm', optional, '(from the targets)', '>0', '', 'pose', &
                  'an angle of 1 rad counts as much as this distance; by default the largest distance between two poses', '0.1', &
                  seldom=.true., program=kinematics), &
    item_row_type('objective', 'goal', 'real', 1, 1, '', optional, '(none)', '', '', 'quantity', &
                  'the value that the quantity should have, in the unit of the results', '0.3'), &
    item_row_type('objective', 'make', 'text', 1, 1, '', optional, '''least''', '', 'least largest', 'quantity', &
                  'without goal: the quantity should be as small as possible, or as large', '''largest'''), &
    item_row_type('objective', 'weight', 'real', 1, 1, '', optional, '1', '>0', '', '', &
                  'factor of its sum of squares, or of the quantity, where there are several objectives', '10', &
                  seldom=.true.), &
    item_row_type('limit', 'kind', 'text', 1, 1, '', needed, '', '', 'quantity assembles crank transmission', '', &
                  'a quantity in a range, assembly through the whole run, a drive that turns fully, or a transmission angle', &
                  '''quantity'''), &
    item_row_type('limit', 'of', 'text', 1, 1, '', needed, '', '', '', 'quantity', &
                  'name of the &quantity', '''stroke'''), &
    item_row_type('limit', 'low', 'real', 1, 1, '', optional, '(none)', '', '', 'quantity', &
                  'the least value that is allowed, in the unit of the results', '0.1'), &
    item_row_type('limit', 'high', 'real', 1, 1, '', optional, '(none)', '', '', 'quantity', &
                  'the largest value that is allowed, in the unit of the results', '0.4'), &
    item_row_type('limit', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', 'crank', &
                  'the driven angle that must be able to turn fully, from its value at the start', '1', &
                  program=kinematics), &
    item_row_type('limit', 'coordinate', 'integer', 1, 1, '', needed, '', '>=1', '', 'transmission', &
                  'the angle between two moving links, as coupler and rocker, at whose pair the transmission angle is measured', &
                  '3', program=kinematics), &
    item_row_type('limit', 'at_least', 'real', 1, 1, 'angle', needed, '', '>0', '', 'transmission', &
                  'the least transmission angle that is allowed in the run; it is at most a right angle', '0.7', &
                  program=kinematics), &
    item_row_type('optimum', 'starts', 'integer', 1, 1, '', optional, '100', '>=1', '', '', &
                  'number of sets of values at which the search starts', '1000'), &
    item_row_type('optimum', 'seed', 'integer', 1, 1, '', optional, '1', '>=0', '', '', &
                  'another seed gives other starts', '2', &
                  seldom=.true.), &
    item_row_type('optimum', 'method', 'text', 1, 1, '', optional, '''auto''', '', &
                  'auto levenberg-marquardt slsqp mma ccsaq auglag', '', &
                  'method of the search: by default Levenberg and Marquardt''s for sums of squares, otherwise slsqp', &
                  '''slsqp''', seldom=.true.)]

  type(item_row_type), parameter :: long_term_items(*) = [ &
    item_row_type('section', 'coordinate', 'integer', 1, 1, '', optional, '(no coordinate)', '>=1', '', '', &
                  'number of the coordinate that has the value at each point', '2'), &
    item_row_type('section', 'column', 'text', 1, 1, '', optional, '(no column)', '', '', '', &
                  'in place of a coordinate: heading of a column of the results that has the value', '''P.vy''', seldom=.true.), &
    item_row_type('section', 'period', 'real', 1, 1, 's', optional, '(no period)', '>0', '', '', &
                  'in place of a value: a point after each such time, the first one at the start', '9.42477796076938', &
                  seldom=.true.), &
    item_row_type('section', 'value', 'real', 1, 1, 'q', optional, '0', '', '', '', &
                  'the value at the points; of a column, in the unit of its heading', '0'), &
    item_row_type('section', 'direction', 'integer', 1, 1, '', optional, '1', '', '', '', &
                  '1: points at which the value grows with time, -1: at which it falls, 0: both', '-1'), &
    item_row_type('section', 'every_turn', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'of a coordinate that turns: also at values that differ by whole turns', '.true.', seldom=.true.), &
    item_row_type('section', 'transient', 'real', 1, 1, 's', optional, '0', '>=0', '', '', &
                  'time from the start before which no point counts', '100'), &
    item_row_type('section', 'table', 'text', 1, 1, '', optional, '''''', '', '', '', &
                  'file for the table of the points; - is standard output', '''section.dat'''), &
    item_row_type('section', 'reduce_angles', 'logical', 1, 1, '', optional, '.false.', '', '', '', &
                  'plots of the section show angles within one turn, from minus half a turn to half a turn', '.true.', &
                  seldom=.true.), &
    item_row_type('exponents', 'transient', 'real', 1, 1, 's', optional, '0', '>=0', '', '', &
                  'time from the start of the motion before which nothing is summed', '100'), &
    item_row_type('exponents', 'time', 'real', 1, 1, 's', optional, '(up to the end)', '>0', '', '', &
                  'time over which the exponents are means', '1000'), &
    item_row_type('periodic', 'period', 'real', 1, 1, 's', optional, '(that of the drives)', '>0', '', '', &
                  'period: a multiple of that of drives, loads and motors; where none follows time, a guess', '9.42477796076938'), &
    item_row_type('periodic', 'starts', 'integer', 1, 1, '', optional, '0', '>=0', '', '', &
                  'random starts beside that of the file, from which other periodic motions are looked for', '20'), &
    item_row_type('branch', 'parameter', 'text', 1, 1, '', needed, '', '', '', '', &
                  'name of the &parameter over which the branches are', '''force'''), &
    item_row_type('branch', 'of', 'text', 1, 1, '', optional, '(from the drives)', '', 'equilibrium position periodic', '', &
                  'positions of rest, positions in which all independent coordinates keep their values, or periodic motions', &
                  '''equilibrium''', seldom=.true.), &
    item_row_type('branch', 'low', 'real', 1, 1, '', optional, '(of the parameter)', '', '', '', &
                  'least value of the parameter, at which branches end', '0'), &
    item_row_type('branch', 'high', 'real', 1, 1, '', optional, '(of the parameter)', '', '', '', &
                  'largest value of the parameter', '20'), &
    item_row_type('branch', 'step', 'real', 1, 1, '', optional, '0.05', '>0', '', '', &
                  'longest step along a branch: 1 is 1 rad, the size of the mechanism, or the range of the parameter', '0.02', &
                  seldom=.true.), &
    item_row_type('branch', 'points', 'integer', 1, 1, '', optional, '1000', '>=1', '', '', &
                  'largest number of points of a branch in each of its two directions', '200', seldom=.true.), &
    item_row_type('branch', 'switch', 'logical', 1, 1, '', optional, '.true.', '', '', '', &
                  'branches that cross at branch points are followed, too', '.false.', seldom=.true.)]
end module mech9_study_grammar
