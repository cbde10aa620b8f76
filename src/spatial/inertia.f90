!> Inertia tensors and the measures of inertia of the paper, (22), (23).
module mech9_inertia
  use mech9_kinds, only: wp
  implicit none
  private
  public :: inertia_in_axes, second_moments

contains

  !> Tensor in frame A from that in frame B, about the same point.
  pure function inertia_in_axes(r_ab, inertia_b) result(inertia_a)
    real(wp), intent(in) :: r_ab(3, 3)        !< turns components in B into components in A
    real(wp), intent(in) :: inertia_b(3, 3)   !< inertia tensor in the axes of B [kg m2]
    real(wp) :: inertia_a(3, 3)

    inertia_a = matmul(r_ab, matmul(inertia_b, transpose(r_ab)))
  end function inertia_in_axes

  !> J'_kl = integral of x_k x_l dm from the inertia tensor: half the trace less J_kk on the diagonal,
  !> -J_kl beside it; (23) with its two cases in their places.
  pure function second_moments(inertia) result(moments)
    real(wp), intent(in) :: inertia(3, 3)   !< inertia tensor about the origin of its axes [kg m2]
    real(wp) :: moments(3, 3), half_trace
    integer :: k

    half_trace = 0.5_wp*(inertia(1, 1) + inertia(2, 2) + inertia(3, 3))
    moments = -inertia
    do k = 1, 3
      moments(k, k) = half_trace - inertia(k, k)
    end do
  end function second_moments
end module mech9_inertia
