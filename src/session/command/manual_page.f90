!> The manual page of a program, in the markup of man(7).
module mech9_manual_page
  use mech9_program_kind, only: kinematics, program_names, belongs_to
  use mech9_text, only: to_text, starts_with
  use mech9_printable, only: with_escapes
  use mech9_options, only: options_table
  use mech9_grammar, only: group_table, item_table, item_row_type, rows_of_group
  use mech9_data_help, only: takes_text, meaning_text, use_text
  use mech9_help_text, only: purpose, option_form, exit_table
  use mech9_version, only: version
  implicit none
  private
  public :: manual_page

  character, parameter :: eol = achar(10)

contains

  !> The whole page, as whole lines.
  pure function manual_page(program) result(page)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: page

    page = '.TH '//program_names(program)//' 1 "" "MECH9 '//version//'" "User Commands"'//eol// &
           '.SH NAME'//eol//line(program_names(program)//' - '//purpose(program))// &
           '.SH SYNOPSIS'//eol//'.B '//program_names(program)//eol//'.RI [ FILE ]'//eol//line('[options]')// &
           description(program)//options_of(program)//conversation(program)//data_file()// &
           examples(program)//environment()//exit_status()
  end function manual_page

  !> The section on the purpose of the program.
  pure function description(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text

    text = '.SH DESCRIPTION'//eol
    if (program == kinematics) then
      text = text//line('Computes the motion of a mechanism with closed kinematic chains whose independent coordinates are &
                        &driven as functions of time: positions, velocities and accelerations of all coordinates &
                        &and of chosen points.')
    else
      text = text//line('Integrates the motion of a mechanism with closed kinematic chains under forces, from &
                        &Lagrange''s equations in its independent coordinates.')
    end if
    text = text// &
      paragraph('The mechanism is described by numbers in a data file: which links meet, which coordinates are &
                &independent, how each pair moves. Mistakes in the file are shown with line and column, all at once.')// &
      paragraph('Results are written to files or standard output, messages to standard error. Progress is shown only &
                &on a terminal.')
  end function description

  !> The section on the options.
  pure function options_of(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text
    integer :: i

    text = '.SH OPTIONS'//eol
    do i = 1, size(options_table)
      if (.not. belongs_to(options_table(i)%program, program)) cycle
      text = text//entry(option_form(options_table(i)), trim(options_table(i)%help))
    end do
  end function options_of

  !> The section on the conversation.
  pure function conversation(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text

    text = '.SH CONVERSATION'//eol// &
      line('Without FILE '//program_names(program)//' asks for the data, one after the other. Enter takes the value in brackets; &
           &? explains the question, back returns to the one before, list shows all answers, quit leaves. A wrong answer &
           &is refused at once with the reason. The structure is checked as soon as it is complete, and the geometry by &
           &assembling the mechanism.')// &
      paragraph('In the summary at the end any answer can be changed, by its number or its name, as in "time end = 2". &
                &The answers are saved as a data file that repeats the run. All answers are kept: after Ctrl-C, or &
                &when the terminal was closed, --resume continues the conversation.')// &
      paragraph('After the run its results can be shown, plotted in the terminal or into a picture, and compared with &
                &those of the previous run; an answer can be changed and the mechanism run again.')// &
      paragraph('On a terminal lines can be edited; the arrow keys recall earlier answers, and Tab completes words. &
                &Answers can also be read from a file or a pipe: '//program_names(program)//' < answers.')
  end function conversation

  !> The section on environment variables.
  pure function environment() result(text)
    character(len=:), allocatable :: text

    text = '.SH ENVIRONMENT'//eol// &
           entry('TERM', 'If its value is dumb, or if it is not set, lines cannot be edited and the cursor is not moved.')
  end function environment

  !> Every group and name of the data file.
  pure function data_file() result(text)
    character(len=:), allocatable :: text
    integer, allocatable :: rows(:)
    integer :: i, k

    text = '.SH DATA FILE'//eol// &
           line('Groups of Fortran namelist, &GROUP NAME=VALUE, ... /, in any order; ! begins a comment. &
                &The option --help-data prints the same text.')
    do i = 1, size(group_table)
      text = text//'.SS '//escaped('&'//trim(group_table(i)%name))//eol// &
             line(trim(group_table(i)%help)//' ('//use_text(group_table(i))//').')
      rows = rows_of_group(group_table(i)%name)
      do k = 1, size(rows)
        text = text//item(item_table(rows(k)))
      end do
    end do
  end function data_file

  !> The entry of one name of the data file.
  pure function item(row) result(text)
    type(item_row_type), intent(in) :: row  !< the name, as a row of item_table
    character(len=:), allocatable :: text, example

    example = trim(row%name)//' = '//trim(row%example)
    if (starts_with(row%example, trim(row%name))) example = trim(row%example)
    text = entry(example, meaning_text(row))//'.br'//eol//line(takes_text(row))
  end function item

  !> The section with examples.
  pure function examples(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text

    text = '.SH EXAMPLES'//eol// &
           entry(program_names(program), 'Ask for a mechanism, save and run it.')// &
           entry(program_names(program)//' --edit mine.nml', 'The same, beginning with the data of a file.')// &
           entry(program_names(program)//' mine.nml --check', &
                 'Read the file, check structure and mobility, assemble the mechanism.')// &
           entry(program_names(program)//' mine.nml --table mine.dat', &
                 'Run it; the table goes to mine.dat.')// &
           entry(program_names(program)//' mine.nml --set time.end=2 --table -', &
                 'Run it for two seconds; the table goes to standard output.')
  end function examples

  !> The section on exit codes.
  pure function exit_status() result(text)
    character(len=:), allocatable :: text
    integer :: i

    text = '.SH EXIT STATUS'//eol
    do i = 1, size(exit_table)
      text = text//entry(to_text(exit_table(i)%code), trim(exit_table(i)%meaning))
    end do
    text = text//paragraph('After 6, 7 and 130 the files hold the results up to the end of the run.')
  end function exit_status

  !> A term with its explanation, indented below it.
  pure function entry(label, words) result(text)
    character(len=*), intent(in) :: label  !< the term
    character(len=*), intent(in) :: words  !< its explanation
    character(len=:), allocatable :: text

    text = '.TP'//eol//'.B "'//escaped(label)//'"'//eol//line(words)
  end function entry

  !> Sentences as a new paragraph.
  pure function paragraph(words) result(text)
    character(len=*), intent(in) :: words  !< the sentences
    character(len=:), allocatable :: text

    text = '.PP'//eol//line(words)
  end function paragraph

  !> Sentences as a line of text that does not begin with a command of roff.
  pure function line(words) result(text)
    character(len=*), intent(in) :: words  !< the sentences
    character(len=:), allocatable :: text

    text = escaped(words)//eol
    if (scan(words(:min(1, len(words))), '.') == 1) text = '\&'//text
  end function line

  !> The text with escapes for the letters that roff would take for commands or replace by others.
  pure function escaped(words) result(text)
    character(len=*), intent(in) :: words  !< text without commands of roff
    character(len=:), allocatable :: text

    text = with_escapes(words, '\-''"^~`', [character(len=5) :: '\e', '\-', '\(aq', '\(dq', '\(ha', '\(ti', '\(ga'])
  end function escaped
end module mech9_manual_page
