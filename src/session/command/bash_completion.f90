!> Completion of a program's command line in bash: a script with the program's options and the data file's names.
module mech9_bash_completion
  use mech9_program_kind, only: program_names, belongs_to
  use mech9_options, only: options_table, no_argument, assignment
  use mech9_grammar, only: group_table, item_table
  implicit none
  private
  public :: bash_completion

  character, parameter :: eol = achar(10)

contains

  !> The script, as whole lines. Bash passes it the command line, split at each `=`; names of files may have any letters.
  pure function bash_completion(program) result(script)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: script

    script = '# Completion of '//program_names(program)//' in bash; made from its tables of options and of the data file.'//eol// &
      '_'//program_names(program)//'() {'//eol// &
      '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} assigns=no'//eol// &
      '  if [[ $word == "=" ]]; then word="" assigns=yes'//eol// &
      '  elif [[ $before == "=" ]]; then before=${COMP_WORDS[COMP_CWORD-2]} assigns=yes; fi'//eol// &
      '  COMPREPLY=()'//eol// &
      '  case $assigns:$before in'//eol// &
      values()//arguments(program)// &
      '    yes:*) return ;;'//eol// &
      '  esac'//eol// &
      '  if [[ $word == -* ]]; then'//eol// &
      '    COMPREPLY=($(compgen -W "'//options_of(program)//'" -- "$word"))'//eol// &
      '  else'//eol// &
      '    compopt -o filenames'//eol// &
      '    mapfile -t COMPREPLY < <(compgen -f -X "!*.nml" -- "$word"; compgen -d -- "$word")'//eol// &
      '  fi'//eol// &
      '}'//eol// &
      'complete -F _'//program_names(program)//' '//program_names(program)//eol
  end function bash_completion

  !> Completion after --set GROUP.NAME= by the words that the name takes.
  pure function values() result(text)
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(item_table)
      if (item_table(i)%words /= '' .and. item_table(i)%high == 1) &
        text = text//choice('yes:'//data_name(i), trim(item_table(i)%words))
      if (item_table(i)%type == 'logical') text = text//choice('yes:'//data_name(i), '.true. .false.')
    end do
  end function values

  !> Completion after each option that takes an argument.
  pure function arguments(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text, label
    integer :: i

    text = ''
    label = ''
    do i = 1, size(options_table)
      associate (option => options_table(i))
        if (.not. belongs_to(option%program, program) .or. option%takes == no_argument) cycle
        label = '*:--'//trim(option%name)
        if (option%form == assignment) then
          text = text//choice(label, names_of_data('='), ' compopt -o nospace;')
        else if (index(option%argument, 'GROUP') > 0) then
          text = text//choice(label, groups_of_data()//names_of_data(''), '', '[[ $word != -* ]] && ')
        else if (index(option%argument, 'PATH') + index(option%argument, 'FILE') > 0) then
          text = text//'    '//label//') compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- "$word"); return ;;'//eol
        else
          text = text//'    '//label//') return ;;'//eol
        end if
      end associate
    end do
  end function arguments

  !> One branch of the `case` of bash, which offers these words.
  pure function choice(label, words, also, condition) result(text)
    character(len=*), intent(in) :: label                !< pattern of bash that the option must match
    character(len=*), intent(in) :: words                !< words offered, with blanks between them
    character(len=*), intent(in), optional :: also       !< another command of bash in the branch
    character(len=*), intent(in), optional :: condition  !< condition of the branch; if it is false, bash goes on after the `case`
    character(len=:), allocatable :: text

    text = '    '//label//')'
    if (present(also)) text = text//also
    text = text//' COMPREPLY=($(compgen -W "'//words//'" -- "$word")); '
    if (present(condition)) text = text//condition
    text = text//'return ;;'//eol
  end function choice

  !> The options of a program, each with its dashes.
  pure function options_of(program) result(text)
    integer, intent(in) :: program                !< kinematics or dynamics
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(options_table)
      if (belongs_to(options_table(i)%program, program)) text = text//' --'//trim(options_table(i)%name)
    end do
    text = text(2:)
  end function options_of

  !> The names of all groups of the data file, each with a blank after it.
  pure function groups_of_data() result(text)
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(group_table)
      text = text//trim(group_table(i)%name)//' '
    end do
  end function groups_of_data

  !> Every GROUP.NAME once, with an ending.
  pure function names_of_data(ending) result(text)
    character(len=*), intent(in) :: ending  !< text appended to each name
    character(len=:), allocatable :: text
    integer :: i

    text = ''
    do i = 1, size(item_table)
      if (index(' '//text, ' '//data_name(i)//ending//' ') == 0) text = text//data_name(i)//ending//' '
    end do
  end function names_of_data

  !> The name of a row of the grammar as GROUP.NAME.
  pure function data_name(row) result(text)
    integer, intent(in) :: row  !< row of item_table
    character(len=:), allocatable :: text

    text = trim(item_table(row)%group)//'.'//trim(item_table(row)%name)
  end function data_name
end module mech9_bash_completion
