!> From the file of a robot to a data file: it is right, tells where it comes from, and never replaces a file that is read.
module test_importing
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_error, only: error_type, exit_done, exit_usage, exit_data, exit_file
  use mech9_text, only: string_type
  use mech9_file_bytes, only: read_bytes
  use mech9_source, only: source_from_text
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_parser, only: parse_document
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_importing, only: import_robot
  use mech9_testing, only: tester_type
  use mech9_test_files, only: save_lines, remove_file
  implicit none
  private
  public :: run

  character(len=*), parameter :: path = 'test_importing.xml', output = 'test_importing.nml'

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('formats')) call formats(tester)
    if (tester%runs('closed_chain')) call closed_chain(tester)
    if (tester%runs('bad_inertia')) call bad_inertia(tester)
    if (tester%runs('refusals')) call refusals(tester)
  end subroutine run

  !> Import a robot; `text` is the data file, empty where there is none.
  subroutine import_lines(tester, lines, program, text, code)
    type(tester_type), intent(inout) :: tester             !< counts the checks
    character(len=*), intent(in) :: lines(:)               !< file of the robot
    integer, intent(in) :: program                         !< kinematics or dynamics
    character(len=:), allocatable, intent(out) :: text     !< the data file
    integer, intent(out) :: code                           !< exit code
    type(string_type) :: inputs(1)
    type(error_type), allocatable :: err

    call save_lines(tester, path, lines)
    inputs(1)%text = path
    call import_robot(program, inputs, output, .true., code)
    call read_bytes(output, text, err)
    if (allocated(err)) text = ''
    call remove_file(path)
    call remove_file(output)
  end subroutine import_lines

  !> Read a data file as the programs do.
  subroutine read_data(tester, text, program, model)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), intent(in) :: text         !< the data file
    integer, intent(in) :: program               !< kinematics or dynamics
    type(model_type), intent(out) :: model       !< the model
    type(document_type) :: document
    type(diagnostics_type) :: diagnostics

    call parse_document(source_from_text('d.nml', text), document, diagnostics)
    call read_model(document, program, model, diagnostics)
    call tester%is_true(.not. diagnostics%failed(), 'the data file is right')
  end subroutine read_data

  !> One pendulum in three formats.
  subroutine formats(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: urdf(4) = [character(len=110) :: '<robot name="r"><link name="a"/><link name="b">', &
      '<inertial><mass value="2"/></inertial></link>', &
      '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>', '</robot>']
    character(len=*), parameter :: mjcf(2) = [character(len=110) :: '<mujoco model="r"><worldbody><body name="b">', &
      '<joint name="j"/><inertial mass="2" pos="0 0 0"/></body></worldbody></mujoco>']
    character(len=*), parameter :: sdf(4) = [character(len=110) :: '<sdf version="1.7"><model name="r"><link name="b">', &
      '<inertial><mass>2</mass></inertial></link>', '<joint name="j" type="revolute"><parent>world</parent><child>b</child>', &
      '</joint></model></sdf>']

    call check_format(urdf, 'URDF')
    call check_format(mjcf, 'MJCF')
    call check_format(sdf, 'SDF')
  contains
    subroutine check_format(lines, name)
      character(len=*), intent(in) :: lines(:)   !< file of the robot
      character(len=*), intent(in) :: name       !< name of its format
      character(len=:), allocatable :: text
      type(model_type) :: model
      integer :: code

      call import_lines(tester, lines, kinematics, text, code)
      call tester%is_true(code == exit_done, name//' is imported')
      call tester%is_true(index(text, 'from '//path//' ('//name//')') > 0, 'the data file tells where it comes from')
      call tester%is_true(index(text, '&drive') > 0, 'kinematics has drives')
      call read_data(tester, text, kinematics, model)
      call tester%is_true(model%mechanism%structure%n_links == 2 .and. model%mechanism%structure%n_coordinates == 1, 'two links')
      call import_lines(tester, lines, dynamics, text, code)
      call tester%is_true(index(text, '&drive') == 0 .and. index(text, '&initial') > 0, 'dynamics has initial values')
    end subroutine check_format
  end subroutine formats

  !> A slider-crank whose loop is a ball joint in a plane: one freedom remains.
  subroutine closed_chain(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text
    type(model_type) :: model
    integer :: code

    call import_lines(tester, [character(len=110) :: '<mujoco><worldbody><body name="crank"><joint name="c" axis="0 0 1"/>', &
      '<body name="rod" pos="0.3 0 0"><joint name="r" axis="0 0 1"/></body></body>', &
      '<body name="slider" pos="1.3 0 0"><joint name="s" type="slide" axis="1 0 0"/></body></worldbody>', &
      '<equality><connect body1="rod" body2="slider" anchor="1 0 0"/></equality>', &
      '<actuator><motor joint="c"/></actuator></mujoco>'], kinematics, text, code)
    call tester%is_true(code == exit_done, 'a closed chain is imported')
    call read_data(tester, text, kinematics, model)
    call tester%is_true(model%mechanism%structure%n_coordinates == 4, 'the ball joint became revolute')
    call tester%is_true(count(model%problem%partition%independent()) == 1, 'one coordinate is independent')
  end subroutine closed_chain

  !> An inertia that no body has is left out, and the head of the file tells it.
  subroutine bad_inertia(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text
    type(model_type) :: model
    integer :: code

    call import_lines(tester, [character(len=110) :: '<robot name="r"><link name="a"/><link name="b"><inertial><mass value="2"/>', &
      '<inertia ixx="1" iyy="1" izz="9"/></inertial></link><joint name="j" type="continuous">', &
      '<parent link="a"/><child link="b"/></joint></robot>'], dynamics, text, code)
    call tester%is_true(code == exit_done, 'a robot with a wrong inertia is imported')
    call tester%is_true(index(text, "the inertia of link 'b'") > 0, 'the file tells that the inertia is left out')
    call tester%is_true(index(text, 'mass = 2') > 0 .or. index(text, 'mass=2') > 0, 'the mass stays')
    call read_data(tester, text, dynamics, model)
  end subroutine bad_inertia

  subroutine refusals(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=:), allocatable :: text
    type(string_type) :: inputs(1)
    integer :: code

    call import_lines(tester, ['<html/>'], kinematics, text, code)
    call tester%is_true(code == exit_data .and. text == '', 'a file that is no robot')
    call import_lines(tester, ['<robot name="r"><link name="a"/></robot>'], kinematics, text, code)
    call tester%is_true(code == exit_data, 'a robot without joints')
    inputs(1)%text = 'there_is_no_such_file.xml'
    call import_robot(kinematics, inputs, output, .true., code)
    call tester%is_true(code == exit_file, 'a file that is not there')
    call save_lines(tester, path, ['<mujoco><worldbody><body><joint/></body></worldbody></mujoco>'])
    inputs(1)%text = path
    call import_robot(kinematics, inputs, './'//path, .true., code)
    call tester%is_true(code == exit_usage, 'a data file that would replace the robot')
    call remove_file(path)
  end subroutine refusals
end module test_importing
