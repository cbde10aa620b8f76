!> The exact derivatives of the energies of a motion by all parameters.
!>
!> Seen by an observer who moves with a link as a parameter changes, the velocity of the link changes by the derivative of its twist
!> in time, and its inertia by its own numbers only. The kinetic energy is the same for this observer.
module mech9_varied_energy
  use mech9_kinds, only: wp
  use mech9_motion_view, only: motion_view_type
  use mech9_motion_change, only: motion_change_type, new_motion_change
  use mech9_model, only: model_type
  use mech9_generalized_forces, only: show_links
  use mech9_twists, only: shift_at
  use mech9_varied_motion, only: varied_motion_type, link_twists
  use mech9_parameter_twists, only: inertia_type, momentum
  use mech9_varied_bodies, only: place_body, change_of_body, change_of_momentum
  use mech9_varied_forces, only: show_change
  implicit none
  private
  public :: varied_energy_type, new_varied_energy, find_varied_energy

  !> The derivatives, and what finds them.
  type :: varied_energy_type
    real(wp), allocatable :: kinetic(:)          !< (P) of the kinetic energy [J per unit of the parameter]
    real(wp), allocatable :: potential(:)        !< (P) of the potential energy of gravity and springs
    integer, allocatable, private :: loaded(:)   !< links whose motion the loads read
    type(motion_view_type), private :: view      !< the motion as loads read it
    type(motion_change_type), private :: change  !< its derivative by one parameter
  end type varied_energy_type

contains

  !> Room for the derivatives of the energies of a model.
  subroutine new_varied_energy(model, motion, self)
    type(model_type), intent(in) :: model             !< the model
    type(varied_motion_type), intent(in) :: motion    !< derivatives of its motion
    type(varied_energy_type), intent(out) :: self     !< gets its room
    logical :: marked(motion%plan%n_links)
    integer :: i

    marked = .false.
    do i = 1, size(model%mechanism%loads)
      call model%mechanism%loads(i)%load%mark_links(marked)
    end do
    self%loaded = pack([(i, i=2, size(marked))], marked(2:))
    associate (m => motion%plan%n_coordinates, links => motion%plan%n_links)
      allocate (self%view%links(links), self%view%q(m), self%view%dq(m))
      self%change = new_motion_change(links, m)
    end associate
    allocate (self%kinetic(motion%n_parameters), self%potential(motion%n_parameters), source=0.0_wp)
  end subroutine new_varied_energy

  !> Find the derivatives in the present motion, after find_varied_motion for this motion.
  subroutine find_varied_energy(model, motion, self)
    type(model_type), intent(in) :: model                !< the model
    type(varied_motion_type), intent(in) :: motion       !< derivatives of its motion
    type(varied_energy_type), intent(inout) :: self      !< gets the derivatives
    integer :: i

    self%kinetic = 0.0_wp
    self%potential = 0.0_wp
    do i = 1, size(model%mechanism%bodies)
      if (model%mechanism%bodies(i)%link /= 1) call add_body(model, i, motion, self)
    end do
    if (size(model%mechanism%loads) > 0) call add_springs(model, motion, self)
  end subroutine find_varied_energy

  !> Add the derivatives of the energies of a body.
  subroutine add_body(model, number, motion, self)
    type(model_type), intent(in) :: model                !< the model
    integer, intent(in) :: number                        !< of the body
    type(varied_motion_type), intent(in) :: motion       !< derivatives of its motion
    type(varied_energy_type), intent(inout) :: self      !< gets the sums
    type(inertia_type) :: body, changed
    real(wp) :: twists(motion%n_parameters, 6, 0:2), r(3, 3), velocity(6), h(6), centre(3)
    integer :: p

    associate (link => model%mechanism%bodies(number)%link, gravity => model%mechanism%gravity)
      call link_twists(motion, link, twists)
      call place_body(model, number, motion, r, body)
      velocity = motion%motion%velocity(:, motion%plan%frame_of(link))
      h = momentum(body, velocity)
      ! the energy of gravity is zero in the origin of link 1
      centre = body%centre + motion%plan%origin
      do p = 1, motion%n_parameters
        self%kinetic(p) = self%kinetic(p) + dot_product(h, twists(p, :, 1))
        self%potential(p) = self%potential(p) - body%mass*(dot_product(gravity, shift_at(twists(p, :, 0), body%centre)) &
                                                           + dot_product(motion%tangents(p)%gravity, centre))
        associate (part => motion%tangents(p)%bodies(number))
          if (.not. part%varies) cycle
          changed = change_of_body(part%change, r)
        end associate
        self%kinetic(p) = self%kinetic(p) + 0.5_wp*dot_product(velocity, change_of_momentum(body, changed, velocity))
        self%potential(p) = self%potential(p) - dot_product(gravity, body%mass*changed%centre + changed%mass*centre)
      end do
    end associate
  end subroutine add_body

  !> Add the derivatives of the energies of all springs.
  subroutine add_springs(model, motion, self)
    type(model_type), intent(in) :: model                !< the model
    type(varied_motion_type), intent(in) :: motion       !< derivatives of its motion
    type(varied_energy_type), intent(inout) :: self      !< gets the sums
    real(wp) :: twists(motion%n_parameters, 6, 0:2, size(self%loaded))
    integer :: i, p

    call show_links(motion%plan, self%loaded, motion%state, self%view)
    do i = 1, size(self%loaded)
      call link_twists(motion, self%loaded(i), twists(:, :, :, i))
    end do
    do p = 1, motion%n_parameters
      call show_change(p, twists, motion, self%loaded, self%view, self%change)
      do i = 1, size(model%mechanism%loads)
        associate (load => model%mechanism%loads(i)%load, part => motion%tangents(p)%loads(i))
          if (part%varies) then
            self%potential(p) = self%potential(p) + load%varied_potential(self%view, self%change, part%change)
          else
            self%potential(p) = self%potential(p) + load%varied_potential(self%view, self%change, [real(wp) ::])
          end if
        end associate
      end do
    end do
  end subroutine add_springs
end module mech9_varied_energy
