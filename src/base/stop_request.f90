!> The question whether work that takes long shall stop; callers answer it.
module mech9_stop_request
  implicit none
  private
  public :: stop_request_type

  type, abstract :: stop_request_type
  contains
    procedure(wanted_interface), deferred :: is_wanted
  end type stop_request_type

  abstract interface
    !> Whether the work shall stop.
    logical function wanted_interface(self)
      import :: stop_request_type
      class(stop_request_type), intent(in) :: self   !< the request
    end function wanted_interface
  end interface
end module mech9_stop_request
