!> How far the closed chains of a block are from a singular position, as a smooth number with exact derivatives.
!>
!> The number is one over the sum of the reciprocal squares of the singular values of the block's Jacobian, with rotations in rad and
!> translations in lengths of the mechanism. It is at most the square of the least singular value, and at least this square over the
!> number of unknowns. Where two branches of a motion are about to meet, as parameters change, both decrease as the square root of the
!> distance from the edge; so the square decreases linearly, which a search can follow to the edge.
module mech9_regularity
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_rotation, only: cross
  use mech9_reflections, only: triangulate, solve_upper
  use mech9_coupling, only: curve_order
  use mech9_coupling_constraint, only: curve_of
  use mech9_twists, only: bracket, shift_at
  use mech9_pair_changes, only: find_pair_change
  use mech9_design_space, only: design_type
  use mech9_open_position, only: open_position_type, place_at, find_derivatives
  use mech9_closed_changes, only: closed_changes_type, find_closed_changes
  use mech9_course_extreme, only: course_number_type, course_place_type
  implicit none
  private
  public :: regularity_type

  !> The regularity of one block.
  type, extends(course_number_type) :: regularity_type
    integer :: block = 0   !< number of the block
  contains
    procedure :: find
  end type regularity_type

contains

  !> The regularity at a position, and its derivatives.
  subroutine find(self, design, position, place, found)
    class(regularity_type), intent(in) :: self               !< of a block
    type(design_type), intent(in) :: design                  !< placed, with its tangents
    type(open_position_type), intent(inout) :: position      !< scratch
    type(course_place_type), intent(inout) :: place          !< with time and coordinates; gets the number
    logical, intent(out) :: found                            !< it exists
    type(closed_changes_type) :: changes
    type(error_type), allocatable :: err
    real(wp), allocatable :: jacobian(:, :), weights(:, :)
    real(wp) :: twists(6, 0:design%in_space%n_coordinates)
    integer :: p

    call place_at(design, place%t, place%q, position, err)
    found = .not. allocated(err)
    if (.not. found) return
    call find_derivatives(design, position)
    call find_closed_changes(design, position, changes)
    call fill_jacobian(self%block, design, position, jacobian)
    call weigh(jacobian, place%value, weights, found)
    if (.not. found) return
    if (.not. allocated(place%by_x)) allocate (place%by_x(size(design%x)))
    call spread_twists(design, position, changes%by_t, twists)
    place%by_t = changed(self%block, design, position, changes%by_t, twists, 0, weights)
    do p = 1, size(design%x)
      call spread_twists(design, position, changes%by_x(:, p), twists)
      twists = twists + position%frames(:, p, :)
      place%by_x(p) = changed(self%block, design, position, changes%by_x(:, p), twists, p, weights)
    end do
  end subroutine find

  !> The Jacobian of a block by its unknowns, each in its unit: six rows for each closed chain, of which redundant ones are included,
  !> and one for each coupling.
  subroutine fill_jacobian(block, design, position, jacobian)
    integer, intent(in) :: block                             !< number of the block
    type(design_type), intent(in) :: design                  !< placed
    type(open_position_type), intent(in) :: position         !< with its frames in place
    real(wp), allocatable, intent(out) :: jacobian(:, :)     !< (rows,unknowns) [rad, lengths of the mechanism]
    real(wp) :: screw(6)
    integer :: c, i, j, row

    associate (plan => design%in_space, state => position%state)
      associate (unknowns => plan%blocks(block)%unknowns)
        allocate (jacobian(rows_of(block, design), size(unknowns)), source=0.0_wp)
        row = 0
        do c = plan%blocks(block)%first_closure, plan%blocks(block)%last_closure
          associate (loop => plan%closures(c)%loop, closing => plan%closures(c)%closing)
            do i = 1, size(loop%steps)
              j = findloc(unknowns, loop%steps(i), dim=1)
              if (j == 0) cycle
              if (plan%closures(c)%coupling > 0) then
                call plan%constraints(c)%item%column(plan, loop%steps(i), loop%signs(i), state, jacobian(row + 1:row + 1, j))
              else
                screw = loop%signs(i)*plan%unit_of(plan%steps(loop%steps(i))%coordinate)*screw_of(position, loop%steps(i))
                jacobian(row + 1:row + 3, j) = screw(1:3)
                jacobian(row + 4:row + 6, j) = shift_at(screw, state%p(:, closing))/plan%length
              end if
            end do
          end associate
          row = row + rows_of_closure(design, c)
        end do
      end associate
    end associate
  end subroutine fill_jacobian

  !> The number of rows of a block's Jacobian.
  pure integer function rows_of(block, design) result(rows)
    integer, intent(in) :: block             !< number of the block
    type(design_type), intent(in) :: design  !< any of the designs
    integer :: c

    rows = 0
    do c = design%in_space%blocks(block)%first_closure, design%in_space%blocks(block)%last_closure
      rows = rows + rows_of_closure(design, c)
    end do
  end function rows_of

  !> The number of rows of one closure.
  pure integer function rows_of_closure(design, c) result(rows)
    type(design_type), intent(in) :: design  !< any of the designs
    integer, intent(in) :: c                 !< number of the closure

    rows = merge(1, 6, design%in_space%closures(c)%coupling > 0)
  end function rows_of_closure

  !> The twist of a step per unit rate.
  pure function screw_of(position, s) result(screw)
    type(open_position_type), intent(in) :: position   !< with its frames in place
    integer, intent(in) :: s                           !< number of the step
    real(wp) :: screw(6)

    associate (state => position%state)
      screw = [state%axis_w(:, s), state%axis_v(:, s) - cross(state%axis_w(:, s), state%p(:, s))]
    end associate
  end function screw_of

  !> The number of a Jacobian J, and its derivatives by the elements: with A = J' J it is one over the trace of A^-1, whose
  !> differential is -2 times the sum of the elements of J A^-2 times those of dJ.
  pure subroutine weigh(jacobian, value, weights, found)
    real(wp), intent(in) :: jacobian(:, :)                !< (rows,unknowns) J
    real(wp), intent(out) :: value                        !< the number
    real(wp), allocatable, intent(out) :: weights(:, :)   !< (rows,unknowns) its derivatives
    logical, intent(out) :: found                         !< J has independent columns
    real(wp) :: triangle(size(jacobian, 1), size(jacobian, 2)), unit(size(jacobian, 2))
    real(wp), dimension(size(jacobian, 2), size(jacobian, 2)) :: inverse, inverse_of_square
    integer :: i, n

    n = size(jacobian, 2)
    triangle = jacobian
    value = 0.0_wp
    found = size(jacobian, 1) >= n
    if (.not. found) return
    call triangulate(triangle, n)
    do i = 1, n
      found = found .and. abs(triangle(i, i)) > 0.0_wp
    end do
    if (.not. found) return
    do i = 1, n
      unit = 0.0_wp
      unit(i) = 1.0_wp
      call solve_upper(triangle(:n, :), unit, inverse(:, i))
    end do
    value = 1.0_wp/sum(inverse**2)
    inverse_of_square = matmul(inverse, transpose(inverse))
    weights = 2.0_wp*value**2*matmul(jacobian, matmul(inverse_of_square, inverse_of_square))
  end subroutine weigh

  !> The twists of all frames by a change of the coordinates.
  pure subroutine spread_twists(design, position, change, twists)
    type(design_type), intent(in) :: design                  !< placed
    type(open_position_type), intent(in) :: position         !< with its frames in place
    real(wp), intent(in) :: change(:)                        !< (M) of the coordinates, in their units
    real(wp), intent(out) :: twists(:, 0:)                   !< (6,0:M) of the frames
    integer :: s, k

    twists(:, 0) = 0.0_wp
    do s = 1, design%in_space%n_coordinates
      k = design%in_space%steps(s)%coordinate
      twists(:, s) = twists(:, design%in_space%steps(s)%parent) &
                     + change(k)*design%in_space%unit_of(k)*screw_of(position, s)
    end do
  end subroutine spread_twists

  !> The change of a block's number by a change of coordinates and of one parameter.
  real(wp) function changed(block, design, position, change, twists, parameter, weights)
    integer, intent(in) :: block                             !< number of the block
    type(design_type), intent(in) :: design                  !< placed, with its tangents
    type(open_position_type), intent(in) :: position         !< with its frames in place
    real(wp), intent(in) :: change(:)                        !< (M) of the coordinates, in their units
    real(wp), intent(in) :: twists(:, 0:)                    !< (6,0:M) of the frames
    integer, intent(in) :: parameter                         !< number of the varied parameter; 0: none changes
    real(wp), intent(in) :: weights(:, :)                    !< (rows,unknowns) derivatives of the number by the Jacobian
    real(wp) :: screw(6), varied(6), shift(3)
    integer :: c, i, j, row

    changed = 0.0_wp
    row = 0
    associate (plan => design%in_space, state => position%state)
      associate (unknowns => plan%blocks(block)%unknowns)
        do c = plan%blocks(block)%first_closure, plan%blocks(block)%last_closure
          associate (loop => plan%closures(c)%loop, closing => plan%closures(c)%closing)
            do i = 1, size(loop%steps)
              j = findloc(unknowns, loop%steps(i), dim=1)
              if (j == 0) cycle
              if (plan%closures(c)%coupling > 0) then
                changed = changed + weights(row + 1, j)*varied_factor(design, position, c, loop%steps(i), change, parameter)
                cycle
              end if
              screw = screw_of(position, loop%steps(i))
              varied = varied_screw(design, position, loop%steps(i), change, twists, parameter)
              shift = shift_at(twists(:, closing), state%p(:, closing))
              shift = (shift_at(varied, state%p(:, closing)) + cross(screw(1:3), shift))/plan%length
              changed = changed + loop%signs(i)*plan%unit_of(plan%steps(loop%steps(i))%coordinate) &
                        *(dot_product(weights(row + 1:row + 3, j), varied(1:3)) + dot_product(weights(row + 4:row + 6, j), shift))
            end do
          end associate
          row = row + rows_of_closure(design, c)
        end do
      end associate
    end associate
  end function changed

  !> The change of the twist of a step per unit rate: it is carried along with its frame, and changes by itself where a parameter sets
  !> its pitch, or the axis of the pair is not fixed.
  function varied_screw(design, position, s, change, twists, parameter) result(varied)
    type(design_type), intent(in) :: design                  !< placed, with its tangents
    type(open_position_type), intent(in) :: position         !< with its frames in place
    integer, intent(in) :: s                                 !< number of the step
    real(wp), intent(in) :: change(:)                        !< (M) of the coordinates, in their units
    real(wp), intent(in) :: twists(:, 0:)                    !< (6,0:M) of the frames
    integer, intent(in) :: parameter                         !< number of the varied parameter; 0: none changes
    real(wp) :: varied(6), by_coordinate(6, 0:2), along
    integer :: k

    associate (plan => design%in_space, state => position%state)
      k = plan%steps(s)%coordinate
      varied = bracket(twists(:, s), screw_of(position, s))
      along = change(k)*plan%unit_of(k)
      if (parameter > 0) then
        associate (tangent => design%tangents(parameter))
          along = along + tangent%offset(k)
          ! the axis is the third one of the step's frame
          varied(4:6) = varied(4:6) + tangent%slide(k)*state%r(:, 3, s)
          if (tangent%pairs(k)%varies) then
            ! second derivatives of a pose do not depend on their order
            call find_pair_change(plan, state, tangent, s, by_coordinate)
            varied = varied + by_coordinate(:, 1)
          end if
        end associate
      end if
      if (plan%steps(s)%is_screw) return
      associate (w_rate => state%axis_w_rate(:, s), v_rate => state%axis_v_rate(:, s))
        varied = varied + along*[w_rate, v_rate - cross(w_rate, state%p(:, s)) - cross(state%axis_w(:, s), state%axis_v(:, s))]
      end associate
    end associate
  end function varied_screw

  !> The change of the derivative of a coupling's equation by the coordinate of a step, in its unit.
  real(wp) function varied_factor(design, position, c, s, change, parameter) result(varied)
    type(design_type), intent(in) :: design                  !< placed, with its tangents
    type(open_position_type), intent(in) :: position         !< with its frames in place
    integer, intent(in) :: c                                 !< number of the closure that is the coupling
    integer, intent(in) :: s                                 !< number of the step
    real(wp), intent(in) :: change(:)                        !< (M) of the coordinates, in their units
    integer, intent(in) :: parameter                         !< number of the varied parameter; 0: none changes
    real(wp) :: curve(0:curve_order)
    integer :: i, k

    associate (plan => design%in_space, number => design%in_space%closures(c)%coupling)
      k = plan%steps(s)%coordinate
      curve = curve_of(plan, c, position%state)
      associate (coupling => plan%couplings(number)%coupling)
        i = findloc(coupling%coordinates, k, dim=1)
        varied = coupling%term(i, position%state%q(k), curve, 2)*change(k)*plan%unit_of(k)
        if (parameter > 0) then
          associate (tangent => design%tangents(parameter)%couplings(number))
            if (tangent%varies) varied = varied + coupling%varied_term(tangent%change, i, position%state%q(k), 1)
          end associate
        end if
      end associate
      varied = plan%closures(c)%weight*plan%unit_of(k)*varied
    end associate
  end function varied_factor
end module mech9_regularity
