!> The topics of a conversation, in the order in which a person thinks. Each topic has some groups of the data file.
module mech9_topics
  use mech9_program_kind, only: dynamics
  use mech9_grammar, only: group_table, find_group_row, words_of
  implicit none
  private
  public :: topic_type, topics, groups_of_topic, is_numbered, can_be_left_out, is_on_request

  !> One topic.
  type :: topic_type
    character(len=24) :: title
    character(len=40) :: groups       !< names of its groups; empty: all groups without another topic
    character(len=420) :: opening     !< text at the beginning of the topic
  end type topic_type

  type(topic_type), parameter :: topics(*) = [ &
    topic_type('The mechanism', 'mechanism', 'Link 1 is the frame; a pair between two links has one coordinate, '// &
               'a ball joint three.'), &
    topic_type('Structure', 'structure', ''), &
    topic_type('Pairs', 'pair', 'Directions and points are three numbers, x y z. The easiest way: choose one position of the '// &
               'mechanism and give all points and directions in the frame, as they are in that position; all coordinates are '// &
               'then 0 there. Where links have systems of their own, they are given in the reference link, and again in the '// &
               'moving link as moving_point, moving_axis and moving_zero.'), &
    topic_type('Names of links', 'link', 'A name of a link may stand for its number. '// &
               'A name begun by mistake is left out by remove.'), &
    topic_type('Couplings', 'coupling', 'Gears, racks, belts and screws couple coordinates. Each coupling makes one more '// &
               'coordinate dependent. A coupling begun by mistake is left out by remove.'), &
    topic_type('Drives', 'drive', 'An independent coordinate with a drive is a given function of time; mech9k needs one '// &
               'for each.'), &
    topic_type('The start', 'initial', ''), &
    topic_type('Bodies', 'body', 'Links without a body are massless. A body begun by mistake is left out by remove.'), &
    topic_type('Gravity', 'gravity', 'It acts on all bodies: -y is 9.81 m/s^2 against y, as on Earth where y points up; '// &
               'none where it is left out.'), &
    topic_type('Loads', 'load', 'Forces, torques, springs and dampers, on links and on coordinates. '// &
               'A load begun by mistake is left out by remove.'), &
    topic_type('Motors', 'motor', 'A motor moves a coordinate without a drive: by direct current, or by a controller. '// &
               'A motor begun by mistake is left out by remove.'), &
    topic_type('Stops', 'stop', 'A stop bounds a coordinate, which bounces off it or comes to rest there. '// &
               'A stop begun by mistake is left out by remove.'), &
    topic_type('Friction', 'friction', 'Dry friction in pairs, by the forces that these pass on. '// &
               'A friction begun by mistake is left out by remove.'), &
    topic_type('Points', 'point', 'Positions, velocities and accelerations of these points are recorded.'), &
    topic_type('Contacts', 'contact', 'A ball about a traced point may touch a plane, a sphere or a path of another link. '// &
               'A contact begun by mistake is left out by remove.'), &
    topic_type('Cams', 'cam', 'A cam whose profile follows from the motion of its follower, for the option --cam. '// &
               'A cam begun by mistake is left out by remove.'), &
    topic_type('Time', 'time', ''), &
    topic_type('Computation', 'solver', ''), &
    topic_type('Results', 'output', ''), &
    topic_type('User procedures', 'user', ''), &
    topic_type('Parameters', 'parameter', 'A parameter is a name for numbers of this file that change together, as a length '// &
               'does that stands at several places. A parameter begun by mistake is left out by remove.'), &
    topic_type('Quantities', 'quantity', 'A quantity is one number from the whole run, such as the stroke of a slider. '// &
               'A quantity begun by mistake is left out by remove.'), &
    topic_type('Study', 'study', 'A study makes a run for each of many sets of values of the parameters, and tells how the '// &
               'quantities change. It is made after the run of this conversation, or by the option --study. '// &
               'A study begun by mistake is left out by remove.'), &
    topic_type('Objectives', 'objective limit optimum', 'An objective is a path, a function, poses or a quantity that the '// &
               'mechanism should have. A limit is a condition that it must meet. '// &
               'What was begun by mistake is left out by remove.'), &
    topic_type('Long-term motion', 'section exponents periodic branch', 'A section has the points at which the motion passes a '// &
               'value, or those after each period. Exponents tell how fast neighbouring motions part (option --exponents). '// &
               'Periodic motions, stable or not, are found by --periodic. Branches show positions of rest over a parameter '// &
               '(option --branch). What was begun by mistake is left out by remove.'), &
    topic_type('Further data', '', '')]

contains

  !> The rows of group_table that belong to a topic, in the order of the topic.
  pure function groups_of_topic(topic) result(rows)
    integer, intent(in) :: topic  !< number of the topic
    integer, allocatable :: rows(:)
    integer :: i, j

    if (topics(topic)%groups /= '') then
      associate (names => words_of(trim(topics(topic)%groups)))
        rows = [(find_group_row(trim(names(i))), i=1, size(names))]
      end associate
    else
      rows = pack([(i, i=1, size(group_table))], &
                  [(.not. any([(has_word(topics(j)%groups, group_table(i)%name), j=1, size(topics))]), &
                    i=1, size(group_table))])
    end if
  end function groups_of_topic

  !> Whether a list of words has a word.
  pure logical function has_word(words, word)
    character(len=*), intent(in) :: words  !< words with blanks between
    character(len=*), intent(in) :: word   !< the word that is looked for

    has_word = index(' '//trim(words)//' ', ' '//trim(word)//' ') > 0
  end function has_word

  !> Whether the groups of a name are distinguished by the number of a coordinate. There is then one for each coordinate
  !> concerned, and no question about the number itself.
  pure logical function is_numbered(group_row)
    integer, intent(in) :: group_row  !< row of the group in group_table

    is_numbered = group_table(group_row)%key == 'coordinate'
  end function is_numbered

  !> Whether a conversation begins groups of a name only where the user asks for one by add.
  pure logical function is_on_request(group_row)
    integer, intent(in) :: group_row  !< row of the group in group_table

    is_on_request = any(group_table(group_row)%name == ['link     ', 'stop     ', 'friction ', 'contact  ', 'parameter', &
                                                        'quantity ', 'study    ', 'objective', 'limit    ', 'optimum  ', &
                                                        'section  ', 'exponents', 'periodic ', 'branch   '])
  end function is_on_request

  !> Whether the user begins the groups of a name, and can leave them out. There can be any number of most of them, and one of
  !> studies and searches. In mech9d, drives are among them: an independent coordinate without one is free.
  pure logical function can_be_left_out(group_row, program)
    integer, intent(in) :: group_row              !< row of the group in group_table
    integer, intent(in) :: program                !< kinematics or dynamics

    can_be_left_out = (group_table(group_row)%repeats .or. is_on_request(group_row)) .and. .not. is_numbered(group_row)
    if (group_table(group_row)%name == 'drive') can_be_left_out = program == dynamics
  end function can_be_left_out
end module mech9_topics
