!> The structure of a mechanism as a graph in the language of Graphviz, and as a picture that dot makes of it.
!>
!> Links are nodes, and pairs are edges, drawn in the order of computation. Links that a block reaches first stand
!> together in a cluster, and the pairs of the block have the colour of the cluster. Independent coordinates have thick
!> edges. Couplings are dashed edges between the moving links of their pairs.
module mech9_structure_graph
  use mech9_error, only: error_type, raise, add_place, exit_file
  use mech9_text, only: string_type, to_text
  use mech9_path, only: ending_of, with_ending
  use mech9_compound_joint, only: compound_joint_type
  use mech9_part_names, only: part_names_type, name_in
  use mech9_mechanism, only: mechanism_type
  use mech9_plan, only: plan_type, block_type
  use mech9_block_names, only: chain_names
  use mech9_text_file, only: save_text
  use mech9_printable, only: printable, with_escapes
  use mech9_child_process, only: child_outcome_type, run_child
  implicit none
  private
  public :: save_structure_graph, text_of_graph

  character, parameter :: line_end = achar(10)
  !> Colours that people with any kind of colour vision can distinguish; the blocks take them in turn.
  character(len=7), parameter :: colours(6) = &
    ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#b07800', '#56b4e9']
  !> The number of links up to which dot lays the graph out in layers, which takes a second. Larger graphs are laid out
  !> by forces between links.
  integer, parameter :: most_layered = 300
  !> The largest number of coordinates of a block that a label lists.
  integer, parameter :: most_listed = 8

contains

  !> Write the graph into a file. By the ending of its name this is a text (.dot, .gv), or a picture (.svg, .png, .pdf)
  !> with the text beside it. If dot is not installed keep the text; `said` tells how to use it.
  subroutine save_structure_graph(path, mechanism, plan, drawn, said, err)
    character(len=*), intent(in) :: path                !< file of the graph or of its picture
    type(mechanism_type), intent(in) :: mechanism       !< the mechanism
    type(plan_type), intent(in) :: plan                 !< the plan of the mechanism
    logical, intent(out) :: drawn                       !< the file was written as it was asked for; else `said` tells the reason
    character(len=:), allocatable, intent(out) :: said  !< a line for the user
    type(error_type), allocatable, intent(out) :: err   !< allocated if it failed
    character(len=:), allocatable :: text, text_path

    text = structure_graph(mechanism, plan)
    text_path = text_of_graph(path)
    said = 'graph: '//path
    drawn = .true.
    call save_text(text_path, text, err)
    if (allocated(err) .or. text_path == path) return
    call draw(path, text, text_path, drawn, said, err)
    call add_place(err, 'no picture of the structure')
  end subroutine save_structure_graph

  !> The file of the text of a graph: the requested file, or one beside the requested picture.
  pure function text_of_graph(path) result(text_path)
    character(len=*), intent(in) :: path  !< file of the graph or of its picture
    character(len=:), allocatable :: text_path

    select case (ending_of(path))
    case ('svg', 'png', 'pdf')
      text_path = with_ending(path, 'dot')
    case default
      text_path = path
    end select
  end function text_of_graph

  !> Let dot draw the picture.
  subroutine draw(path, text, text_path, drawn, said, err)
    character(len=*), intent(in) :: path                  !< file of the picture
    character(len=*), intent(in) :: text                  !< text of the graph
    character(len=*), intent(in) :: text_path             !< file of the text of the graph
    logical, intent(out) :: drawn                         !< the picture was drawn
    character(len=:), allocatable, intent(inout) :: said  !< a line for the user; replaced where dot is not there
    type(error_type), allocatable, intent(out) :: err     !< allocated if it failed
    type(child_outcome_type) :: outcome
    type(string_type) :: words(3)

    words(1)%text = 'dot'
    words(2)%text = '-T'//ending_of(path)
    words(3)%text = '-o'//path
    call run_child(words, text, outcome, err)
    drawn = .not. allocated(err) .and. outcome%found
    if (allocated(err)) return
    if (.not. outcome%found) then
      said = 'graph: dot is not here; install Graphviz (Debian: apt-get install graphviz) and run: '// &
             'dot -T'//ending_of(path)//' -o '//path//' '//text_path
    else if (outcome%code /= 0) then
      call raise(err, exit_file, 'dot ended with '//to_text(outcome%code)//': '//trim(printable(outcome%error_output)))
    end if
  end subroutine draw

  !> The text of the graph.
  pure function structure_graph(mechanism, plan) result(text)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    character(len=:), allocatable :: text
    integer :: b

    text = 'graph mechanism {'//line_end
    if (mechanism%title /= '') text = text//'  label='//quoted(mechanism%title)//'; labelloc=t; fontsize=18;'//line_end
    if (mechanism%structure%shown_links() > most_layered) &
      text = text//'  layout=sfdp; overlap=prism; outputorder=edgesfirst;'//line_end
    text = text//'  fontname="sans-serif"; ranksep=0.6; nodesep=0.5;'//line_end// &
           '  node [fontname="sans-serif", shape=circle, style=filled, fillcolor=white, width=0.5, fixedsize=true];'// &
           line_end//'  edge [fontname="sans-serif", fontsize=11];'//line_end// &
           '  1 [shape=box, width=0.9, fillcolor="#d8d8d8", penwidth=2, label="1 '//frame_name(mechanism%names)//'"];'//line_end
    do b = 1, size(plan%blocks)
      text = text//cluster(mechanism, plan, b)
    end do
    do b = 1, size(plan%blocks)
      text = text//edges(mechanism, plan, b)
    end do
    do b = 1, size(plan%couplings)
      text = text//coupled_links(mechanism, plan, b)
    end do
    text = text//'}'//line_end
  end function structure_graph

  !> The dashed edges of a coupling, between the moving links of its pairs.
  pure function coupled_links(mechanism, plan, number) result(text)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer, intent(in) :: number                  !< of the coupling
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    associate (coupling => plan%couplings(number)%coupling)
      do i = 2, size(coupling%coordinates)
        text = text//'  '//to_text(shown_link(mechanism, coupling%coordinates(i - 1)))//' -- '// &
               to_text(shown_link(mechanism, coupling%coordinates(i)))//' [style=dashed, constraint=false, color="#555555", '// &
               'label="'//trim(coupling%kind_name())//' '//to_text(number)//'"];'//line_end
      end do
    end associate
  end function coupled_links

  !> The moving link of a pair; for a pair of a joint with several freedoms, that of the joint.
  pure integer function shown_link(mechanism, coordinate) result(link)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    integer, intent(in) :: coordinate              !< number of the pair's coordinate
    integer :: j

    link = mechanism%pairs(coordinate)%pair%moving
    j = mechanism%structure%joint_of_link(link)
    if (j > 0) link = mechanism%structure%joints(j)%ends(2)
  end function shown_link

  !> The links that a block reaches first.
  pure function cluster(mechanism, plan, b) result(text)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer, intent(in) :: b                       !< number of the block
    character(len=:), allocatable :: text
    integer :: s

    text = '  subgraph cluster_'//to_text(b)//' {'//line_end// &
           '    label='//quoted('block '//to_text(b)//': '//words_of(mechanism%names, plan, plan%blocks(b)))//'; labelloc=b; '// &
           'fontsize=11; style=rounded; color="'//colour(b)//'"; fontcolor="'//colour(b)//'";'//line_end
    do s = plan%blocks(b)%first_step, plan%blocks(b)%last_step
      if (plan%frame_of(plan%steps(s)%link) == s .and. mechanism%structure%joint_of_link(plan%steps(s)%link) == 0) &
        text = text//'    '//to_text(plan%steps(s)%link)//' [color="'//colour(b)//'"'// &
               label_of_link(mechanism%names, plan%steps(s)%link)//'];'//line_end
    end do
    text = text//'  }'//line_end
  end function cluster

  !> The name of link 1: frame, unless the user gives it another one.
  pure function frame_name(names) result(text)
    type(part_names_type), intent(in) :: names   !< of links and pairs
    character(len=:), allocatable :: text

    text = 'frame'
    if (name_in(names%links, 1) /= '') text = trim(name_in(names%links, 1))
  end function frame_name

  !> The label of a node for a link that has a name: its number, and the name below; a link without one keeps its number alone.
  pure function label_of_link(names, link) result(text)
    type(part_names_type), intent(in) :: names   !< of links and pairs
    integer, intent(in) :: link                  !< number of the link
    character(len=:), allocatable :: text

    text = ''
    if (name_in(names%links, link) /= '') &
      text = ', shape=ellipse, fixedsize=false, label="'//to_text(link)//'\n'//trim(name_in(names%links, link))//'"'
  end function label_of_link

  !> The name of a coordinate behind its number; empty where there is none.
  pure function name_behind(names, coordinate) result(text)
    type(part_names_type), intent(in) :: names   !< of links and pairs
    integer, intent(in) :: coordinate            !< its number
    character(len=:), allocatable :: text

    text = ''
    if (name_in(names%coordinates, coordinate) /= '') text = ' '//trim(name_in(names%coordinates, coordinate))
  end function name_behind

  !> The chains that a block closes, and the coordinates for which it solves them.
  pure function words_of(names, plan, block) result(words)
    type(part_names_type), intent(in) :: names   !< of links and pairs
    type(plan_type), intent(in) :: plan          !< the plan of the mechanism
    type(block_type), intent(in) :: block        !< the block
    character(len=:), allocatable :: words
    integer :: i, listed

    words = chain_names(block%chains)
    listed = min(size(block%unknowns), most_listed)
    do i = 1, listed
      associate (k => plan%steps(block%unknowns(i))%coordinate)
        words = words//trim(merge(' for', ',   ', i == 1))//' q'//to_text(k)//name_behind(names, k)
      end associate
    end do
    if (listed > 0 .and. listed < size(block%unknowns)) words = words//', ...'
  end function words_of

  !> The pairs of a block as edges, each from the link that is known before.
  pure function edges(mechanism, plan, b) result(text)
    type(mechanism_type), intent(in) :: mechanism  !< the mechanism
    type(plan_type), intent(in) :: plan            !< the plan of the mechanism
    integer, intent(in) :: b                       !< number of the block
    character(len=:), allocatable :: text
    integer :: s, j, k, from

    text = ''
    do s = plan%blocks(b)%first_step, plan%blocks(b)%last_step
      associate (step => plan%steps(s))
        k = step%coordinate
        j = mechanism%structure%joint_of(k)
        if (j > 0) then
          if (k == mechanism%structure%first_of_joint(k)) text = text//edge_of_joint(mechanism%structure%joints(j), plan, b)
          cycle
        end if
        from = sum(mechanism%structure%links(:, k)) - step%link
        text = text//'  '//to_text(from)//' -- '//to_text(step%link)//' [color="'//colour(b)//'", label="   q'// &
               to_text(k)//name_behind(mechanism%names, k)//' '//trim(mechanism%pairs(k)%pair%kind_name())//'\l'
        if (.not. step%dependent) text = text//'   independent\l", penwidth="4'
        text = text//'"];'//line_end
      end associate
    end do
  end function edges

  !> A joint with several freedoms as one edge.
  pure function edge_of_joint(joint, plan, b) result(text)
    type(compound_joint_type), intent(in) :: joint  !< the joint
    type(plan_type), intent(in) :: plan             !< the plan of the mechanism
    integer, intent(in) :: b                        !< number of the block
    character(len=:), allocatable :: text
    logical :: independent(joint%freedoms)
    integer :: i

    independent = [(.not. plan%steps(plan%step_of(joint%numbers(i)))%dependent, i=1, joint%freedoms)]
    text = '  '//to_text(joint%ends(1))//' -- '//to_text(joint%ends(2))//' [color="'//colour(b)//'", label="   q'// &
           to_text(joint%coordinates(), ', q')//' '//trim(joint%kind)//'\l'
    if (all(independent)) then
      text = text//'   independent\l", penwidth="4'
    else if (any(independent)) then
      text = text//'   independent: q'//to_text(pack(joint%coordinates(), independent), ', q')//'\l", penwidth="4'
    end if
    text = text//'"];'//line_end
  end function edge_of_joint

  !> The colour of a block.
  pure character(len=7) function colour(b)
    integer, intent(in) :: b  !< number of the block

    colour = colours(1 + modulo(b - 1, size(colours)))
  end function colour

  !> Any text as a string of Graphviz. Between double quotes only the double quote, the backslash and `&`, which begins
  !> names of letters, have a meaning.
  pure function quoted(text) result(string)
    character(len=*), intent(in) :: text  !< any bytes
    character(len=:), allocatable :: string

    string = '"'//with_escapes(printable(text), '"\&', [character(len=5) :: '\"', '\\', '&amp;'])//'"'
  end function quoted
end module mech9_structure_graph
