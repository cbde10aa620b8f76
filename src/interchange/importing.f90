!> The import of robots: from an XML file in one of several formats to a data file.
module mech9_importing
  use, intrinsic :: iso_fortran_env, only: error_unit
  use mech9_program_kind, only: kinematics, dynamics, program_names
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, exit_done, exit_internal, exit_usage, exit_data, exit_structure
  use mech9_text, only: to_text, string_type
  use mech9_counted, only: counted
  use mech9_printable, only: printable
  use mech9_path, only: name_of
  use mech9_same_file, only: file_place_type, find_place, same_place
  use mech9_source, only: span_type, source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_text_file, only: save_text, replace_text
  use mech9_draft, only: draft_type
  use mech9_draft_text, only: draft_text_type, write_draft, locate
  use mech9_xml_tree, only: xml_tree_type
  use mech9_xml_reader, only: read_xml
  use mech9_robot, only: robot_type
  use mech9_urdf_reader, only: read_urdf, read_loops
  use mech9_mjcf_includes, only: follow_includes
  use mech9_mjcf_reader, only: read_mjcf
  use mech9_sdf_reader, only: read_sdf
  use mech9_robot_poses, only: make_planar_loops_planar
  use mech9_rigid_links, only: join_rigid_links
  use mech9_pair_series, only: series_type, find_series
  use mech9_robot_start, only: find_start
  use mech9_robot_draft, only: draft_of_robot
  implicit none
  private
  public :: import_robot, import_as_text

  character, parameter :: eol = achar(10)
  character(len=*), parameter :: beside_singular = 'The robot''s own position is singular; the start lies beside it.'

contains

  !> Import a robot. `code` is the exit code of the program.
  subroutine import_robot(program, inputs, output, quiet, code)
    integer, intent(in) :: program                 !< kinematics or dynamics
    type(string_type), intent(in) :: inputs(:)     !< path of the robot, and perhaps that of its loops
    character(len=*), intent(in) :: output         !< path of the data file; empty or '-': standard output
    logical, intent(in) :: quiet                   !< write errors only
    integer, intent(out) :: code                   !< exit code of the program
    type(robot_type) :: robot
    type(string_type), allocatable :: files(:), messages(:)
    character(len=:), allocatable :: text, summary
    type(error_type), allocatable :: err
    integer :: i

    call make_data_file(program, inputs, robot, files, text, summary, err)
    if (.not. allocated(err)) call refuse_overwriting(files, output, err)
    if (.not. allocated(err)) then
      if (output == '' .or. output == '-') then
        call save_text('-', text, err)
      else
        call replace_text(output, text, err)
      end if
    end if
    code = exit_done
    if (allocated(err)) then
      code = err%code
      write (error_unit, '(3a)') program_names(program), ': ', err%message
    else if (.not. quiet) then
      call list_notes(robot, messages)
      do i = 1, size(messages)
        write (error_unit, '(a)') messages(i)%text
      end do
      write (error_unit, '(3a)') program_names(program), ': ', summary
    end if
  end subroutine import_robot

  !> Import a robot as the text of a data file. Fails with exit_file, exit_data or exit_structure.
  subroutine import_as_text(program, inputs, text, messages, err)
    integer, intent(in) :: program                                !< kinematics: drives hold the robot, or dynamics
    type(string_type), intent(in) :: inputs(:)                    !< path of the robot, and perhaps that of its loops
    character(len=:), allocatable, intent(out) :: text            !< the data file
    type(string_type), allocatable, intent(out) :: messages(:)    !< lines of things that are left out, and a summary
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    type(robot_type) :: robot
    type(string_type), allocatable :: files(:), notes(:)
    character(len=:), allocatable :: summary
    integer :: i

    call make_data_file(program, inputs, robot, files, text, summary, err)
    if (allocated(err)) return
    call list_notes(robot, notes)
    allocate (messages(size(notes) + 1))
    do i = 1, size(notes)
      call move_alloc(notes(i)%text, messages(i)%text)
    end do
    messages(size(messages))%text = summary
  end subroutine import_as_text

  !> From the files of the robot to the text of a data file.
  subroutine make_data_file(program, inputs, robot, files, text, summary, err)
    integer, intent(in) :: program                         !< kinematics or dynamics
    type(string_type), intent(in) :: inputs(:)             !< path of the robot, and perhaps that of its loops
    type(robot_type), intent(out) :: robot                 !< the robot, with notes about what is not taken over
    type(string_type), allocatable, intent(out) :: files(:)   !< paths of all files that were read
    character(len=:), allocatable, intent(out) :: text     !< the data file
    character(len=:), allocatable, intent(out) :: summary  !< numbers of links and so on, in words
    type(error_type), allocatable, intent(out) :: err      !< allocated if it failed
    type(series_type) :: series

    call read_robot(inputs, robot, files, err)
    if (.not. allocated(err)) call join_rigid_links(robot, err)
    if (allocated(err)) return
    call make_planar_loops_planar(robot)
    call find_series(robot, series, err)
    if (allocated(err)) return
    if (size(series%pairs) == 0) then
      call raise(err, exit_data, printable(inputs(1)%text)//': the robot has no joints that move, so that there is no '// &
                 'motion to compute; a mechanism needs one joint at least that is not fixed')
    else
      call write_robot(program, name_of(inputs(1)%text), robot, series, text, summary, err)
    end if
  end subroutine make_data_file

  !> Fail if the data file would be written over a file that is read.
  subroutine refuse_overwriting(files, output, err)
    type(string_type), intent(in) :: files(:)          !< paths of the files that are read
    character(len=*), intent(in) :: output             !< path of the data file
    type(error_type), allocatable, intent(out) :: err  !< allocated if it would
    type(file_place_type) :: from, to
    integer :: i

    if (output == '' .or. output == '-') return
    call find_place(output, to)
    do i = 1, size(files)
      call find_place(files(i)%text, from)
      if (.not. (from%exists .and. same_place(from, to))) cycle
      call raise(err, exit_usage, "--out '"//output//"' would overwrite '"//files(i)%text// &
                 "', which is read; give it another name")
      return
    end do
  end subroutine refuse_overwriting

  !> Read the files; the root of the first one tells its format.
  subroutine read_robot(inputs, robot, files, err)
    type(string_type), intent(in) :: inputs(:)                !< path of the robot, and perhaps that of its loops
    type(robot_type), intent(out) :: robot                    !< the robot
    type(string_type), allocatable, intent(out) :: files(:)   !< paths of all files that were read
    type(error_type), allocatable, intent(out) :: err         !< allocated if it failed
    type(xml_tree_type) :: tree, loops

    call read_xml(inputs(1)%text, tree, err)
    if (allocated(err)) return
    select case (tree%name(1))
    case ('robot')
      call robot%begin('URDF')
      call read_urdf(tree, robot, err)
    case ('mujoco')
      call robot%begin('MJCF')
      call follow_includes(tree, err)
      if (.not. allocated(err)) call read_mjcf(tree, robot, err)
    case ('sdf')
      call robot%begin('SDF')
      call read_sdf(tree, robot, err)
    case default
      call tree%fail(1, '<'//tree%name(1)//'> is no robot: the file must begin with <robot> (URDF), <mujoco> (MJCF) or <sdf>', err)
    end select
    allocate (files(size(tree%files) + size(inputs) - 1))
    files(:size(tree%files)) = tree%files
    if (size(inputs) > 1) files(size(files))%text = inputs(2)%text
    if (size(inputs) > 1 .and. .not. allocated(err)) then
      call read_xml(inputs(2)%text, loops, err)
      if (.not. allocated(err)) call read_loops(loops, robot, err)
    end if
    if (.not. allocated(err)) call robot%judge_leaders(err)
    if (.not. allocated(err)) call robot%finish()
  end subroutine read_robot

  !> The data file as text, with start and independent coordinates, and a line about it.
  subroutine write_robot(program, file, robot, series, text, summary, err)
    integer, intent(in) :: program                                !< kinematics or dynamics
    character(len=*), intent(in) :: file                          !< name of the file that was imported
    type(robot_type), intent(inout) :: robot                      !< the robot; gets notes
    type(series_type), intent(in) :: series                       !< its pairs
    character(len=:), allocatable, intent(out) :: text            !< the data file
    character(len=:), allocatable, intent(out) :: summary         !< numbers of links and so on, in words
    type(error_type), allocatable, intent(out) :: err             !< allocated if it failed
    logical :: independent(size(series%pairs)), preferred(size(series%pairs))
    real(wp) :: q(size(series%pairs))
    type(draft_type) :: draft
    type(draft_text_type) :: written
    class(model_type), allocatable :: model
    logical :: moved, follows(size(series%pairs))
    integer :: chains, k, leader

    allocate (model)
    q = robot%joints(series%pairs%joint)%start
    chains = count(series%closes)
    independent = .true.
    moved = .false.
    do k = 1, size(q)
      leader = robot%leader_of(series%pairs(k)%joint)
      follows(k) = leader > 0
      if (leader > 0) q(k) = robot%joints(series%pairs(k)%joint)%ratio*robot%joints(leader)%start + &
                             robot%joints(series%pairs(k)%joint)%offset
      if (leader > 0 .or. .not. allocated(robot%joints(series%pairs(k)%joint)%leader)) cycle
      call robot%note_at(robot%joints(series%pairs(k)%joint)%place, "the coupling of joint '"// &
                         robot%joints(series%pairs(k)%joint)%name//"' with joint '"// &
                         robot%joints(series%pairs(k)%joint)%leader//"', which has not one freedom")
    end do
    if (chains > 0 .or. any(follows)) then
      independent(2:) = .false.
      call draft_of_robot(robot, series, independent, q, .false., draft)
      call take_model(draft, robot, model, err)
      if (allocated(err)) return
      preferred = robot%joints(series%pairs%joint)%is_preferred
      if (.not. any(preferred)) preferred = .not. (series%closes(series%pairs%joint) .or. follows)
      call find_start(model%mechanism, preferred, q, independent, moved, err)
      if (.not. (allocated(err) .or. any(independent))) &
        call raise(err, exit_structure, 'the robot cannot move: its closed chains and the joints that follow others hold all '// &
                   'coordinates; look for joints that follow each other')
      if (allocated(err)) then
        err%message = printable(file)//': '//err%message
        return
      end if
    end if
    call draft_of_robot(robot, series, independent, q, program == kinematics, draft)
    call take_model(draft, robot, model, err)
    if (allocated(err)) return
    draft%head = head_of(program, file, robot, series)
    if (moved) draft%head = draft%head//'!'//eol//'! '//beside_singular//eol
    call write_draft(draft, '', written)
    call move_alloc(written%text, text)
    summary = counted(series%n_links, 'link')//', '//counted(size(q), 'coordinate')//', '//counted(chains, 'closed chain')// &
              '; independent: '//to_text(pack([(k, k=1, size(q))], independent), ', ')
    if (moved) summary = summary//eol//beside_singular
  end subroutine write_robot

  !> Read a draft as the programs will. Inertias that no body has are taken out, with a note.
  subroutine take_model(draft, robot, model, err)
    type(draft_type), intent(inout) :: draft           !< the data file; may lose inertias
    type(robot_type), intent(inout) :: robot           !< gets notes
    type(model_type), intent(out) :: model             !< the model
    type(error_type), allocatable, intent(out) :: err  !< allocated if the file has other errors
    type(draft_text_type) :: written
    type(diagnostics_type) :: diagnostics
    type(document_type) :: document
    type(span_type) :: span
    character(len=:), allocatable :: message
    logical :: changed(size(draft%groups))
    integer :: i, group, entry

    call write_draft(draft, '', written)
    call parse_document(source_from_text('imported', written%text), document, diagnostics)
    call read_model(document, dynamics, model, diagnostics)
    if (.not. diagnostics%failed()) return
    changed = .false.
    do i = 1, diagnostics%known()
      call diagnostics%get(i, message, span)
      group = 0
      if (span%source == 1) call locate(written, span%first, group, entry)
      if (group > 0) changed(group) = draft%groups(group)%name == 'body'
      if (group == 0 .or. .not. any(changed)) then
        call raise(err, exit_internal, 'the data file that was made has an error: '//message)
        return
      end if
      if (.not. changed(group)) cycle
      call leave_inertia_out(draft, group, message, robot)
    end do
    call write_draft(draft, '', written)
    diagnostics = diagnostics_type()
    call parse_document(source_from_text('imported', written%text), document, diagnostics)
    call read_model(document, dynamics, model, diagnostics)
    if (.not. diagnostics%failed()) return
    call diagnostics%get(1, message, span)
    call raise(err, exit_internal, 'the data file that was made has an error: '//message)
  end subroutine take_model

  !> Take the inertia out of a body, with a note about the reason.
  subroutine leave_inertia_out(draft, group, reason, robot)
    type(draft_type), intent(inout) :: draft   !< the data file
    integer, intent(in) :: group               !< number of the group of the body
    character(len=*), intent(in) :: reason     !< the message about it
    type(robot_type), intent(inout) :: robot   !< gets the note
    integer :: i, n

    n = size(draft%groups(group)%entries)
    if (draft%groups(group)%entries(n)%name /= 'inertia') return
    call draft%take_away('body', draft%place_of(group), 'inertia')
    do i = 1, size(robot%links)
      if (draft%groups(group)%comment /= '! link '//printable(robot%links(i)%name)//eol) cycle
      call robot%note_at(robot%links(i)%place, "the inertia of link '"//robot%links(i)%name//"': "//reason)
    end do
  end subroutine leave_inertia_out

  !> The comment at the beginning of the data file: its origin, the links, and all that is not taken over.
  function head_of(program, file, robot, series) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=*), intent(in) :: file          !< name of the file that was imported
    type(robot_type), intent(in) :: robot         !< the robot
    type(series_type), intent(in) :: series       !< its pairs
    character(len=:), allocatable :: text
    integer :: i

    text = '! Imported by '//program_names(program)//' from '//printable(file)//' ('//robot%format//'). '// &
           'Lengths are in m, masses in kg, angles in rad.'//eol//'!'//eol
    do i = 1, size(robot%links)
      text = text//'! Link '//to_text(series%number_of(i))//': '//printable(robot%links(i)%name)//eol
    end do
    if (series%n_links > size(robot%links)) &
      text = text//'! The other links are massless; they stand between both turns of universal joints.'//eol
    if (robot%n_notes > 0) text = text//'!'//eol//'! Not taken over:'//eol
    do i = 1, robot%n_notes
      text = text//'!   '//note_text(robot, i)//eol
    end do
  end function head_of

  !> List a line about each thing that is not taken over.
  subroutine list_notes(robot, lines)
    type(robot_type), intent(in) :: robot                       !< the robot
    type(string_type), allocatable, intent(out) :: lines(:)     !< the lines, with the places of the things
    integer :: i

    allocate (lines(robot%n_notes))
    do i = 1, robot%n_notes
      lines(i)%text = printable(robot%notes(i)%place)//': not taken over: '//note_text(robot, i)
    end do
  end subroutine list_notes

  !> A note in words, with the number of times.
  function note_text(robot, i) result(text)
    type(robot_type), intent(in) :: robot  !< the robot
    integer, intent(in) :: i               !< number of the note
    character(len=:), allocatable :: text

    text = printable(robot%notes(i)%text)
    if (robot%notes(i)%times > 1) text = text//' ('//to_text(robot%notes(i)%times)//' times)'
  end function note_text
end module mech9_importing
