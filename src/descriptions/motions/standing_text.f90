!> Words on a motion that takes long to reach its next output.
module mech9_standing_text
  use mech9_named_words, only: named_number
  use mech9_kinds, only: wp
  use mech9_simulation_tolerances, only: doubtful_conditioning
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_result_units, only: rate_unit_of, rate_unit_name
  use mech9_simulation, only: standing_type
  implicit none
  private
  public :: standing_text

contains

  !> Place of the motion and the reason for short steps, as: t = 0.2447 s, in steps of 3.5e-9 s; q14 moves fastest, at 2.1e7 rad/s.
  pure function standing_text(model, standing) result(text)
    type(model_type), intent(in) :: model            !< the model
    type(standing_type), intent(in) :: standing      !< of its motion
    character(len=:), allocatable :: text

    text = 't = '//to_text(standing%t, 10)//' s'
    if (standing%step > 0.0_wp) text = text//', in steps of '//to_text(standing%step, 2)//' s'
    if (standing%fastest > 0) then
      associate (k => standing%fastest, mechanism => model%mechanism)
        text = text//'; q'//named_number(mechanism%names%coordinates, k)//' moves fastest, at '// &
               to_text(standing%rate/rate_unit_of(mechanism, k), 3)//' '//trim(rate_unit_name(mechanism, k))
      end associate
    end if
    if (standing%conditioning < doubtful_conditioning) &
      text = text//'; closed chains are near a singular position (conditioning '//to_text(standing%conditioning, 2)//')'
  end function standing_text
end module mech9_standing_text
