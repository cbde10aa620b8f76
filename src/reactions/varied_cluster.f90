!> The derivatives by all parameters of the wrenches of a cluster of closed chains, unique or of least norm.
!>
!> The wrenches r of least norm satisfy B r = b, N r = c and r = P (B^T y + N^T m), see mech9_cluster_balance: the balance of the links,
!> the loads along dependent coordinates, and displacements y of the links with forces m along the coordinates (P: the number of pairs
!> that count as one). In a regular position the rows of B and N are independent, before and after a change, so that all three
!> equations can be differentiated: r' has the same equations, with right-hand sides b' - B' r, c' - N' r and P (B'^T y + N'^T m).
!> Components that equilibrium determines depend on the first two alone.
module mech9_varied_cluster
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use mech9_kinds, only: wp
  use mech9_reaction_tolerances, only: equal_lengths
  use mech9_rotation, only: cross
  use mech9_link_requirements, only: link_requirements_type
  use mech9_reaction_plan, only: reaction_plan_type, joined_cluster_type
  use mech9_joint_geometry, only: joint_geometry_type
  use mech9_cluster_balance, only: cluster_balance_type, new_cluster_balance
  use mech9_singular_cluster, only: singular_cluster_type, decompose_cluster
  use mech9_varied_geometry, only: varied_geometry_type
  implicit none
  private
  public :: varied_position_type, equations_type, new_equations, vary_cluster

  !> A position of the mechanism with its derivatives by the parameters, and what the links require in it.
  type :: varied_position_type
    type(joint_geometry_type) :: geometry      !< of the position
    type(varied_geometry_type) :: changes      !< its derivatives
    type(link_requirements_type) :: links      !< requirements of the links, with all that stands on them, and loads
    real(wp), allocatable :: sizes(:)          !< (P) change of the constants by each parameter, as a part of them
  end type varied_position_type

  !> The wrenches of a cluster in one position, and what belongs to them. Scaled: force, then moment over the length.
  type :: balanced_type
    real(wp), allocatable :: wrenches(:, :)   !< (6,pairs) about the points of the pairs
    real(wp), allocatable :: motions(:, :)    !< (6,pairs) B^T y: motion of the moving link in the reference link
    real(wp), allocatable :: along(:)         !< (pairs) m, the force along a dependent coordinate; zero for others
    real(wp) :: largest = 0.0_wp              !< number by whose round-off balance is judged: of wrenches, loads and forces of couplings
  end type balanced_type

  !> A change by a parameter.
  type :: change_type
    integer :: p = 0               !< number of the parameter; 0: the length by which moments are divided changes alone
    real(wp) :: longer = 0.0_wp    !< derivative of this length [m per unit]
    real(wp) :: size = 0.0_wp      !< change of the constants, as a part of them
  end type change_type

  !> The equations of one cluster in one position. Those of a cluster with couplings are singular, since its links can move where the
  !> coordinates do not satisfy the couplings; the forces of these are known, and count as loads.
  type :: equations_type
    type(joined_cluster_type) :: cluster
    type(cluster_balance_type) :: balance
    type(balanced_type), private :: present     !< the balance of the position
    real(wp), private :: tolerance = 0.0_wp     !< of ranks
    type(singular_cluster_type), allocatable, private :: singular   !< allocated if the equations are singular
  contains
    procedure :: set_position
    procedure :: complete
    procedure :: remove_determined
  end type equations_type

contains

  !> Room for the equations of a cluster.
  pure function new_equations(reactions, cluster, tolerance) result(self)
    type(reaction_plan_type), intent(in) :: reactions   !< the plan of inverse dynamics
    type(joined_cluster_type), intent(in) :: cluster    !< the cluster
    real(wp), intent(in) :: tolerance                   !< of ranks
    type(equations_type) :: self

    self%cluster = cluster
    self%tolerance = tolerance
    self%balance = new_cluster_balance(reactions, cluster)
  end function new_equations

  !> The equations of a position, factorized.
  subroutine set_position(self, reactions, geometry)
    class(equations_type), intent(inout) :: self          !< gets the factors
    type(reaction_plan_type), intent(in) :: reactions     !< the plan of inverse dynamics
    type(joint_geometry_type), intent(in) :: geometry     !< of the position
    logical :: regular

    if (allocated(self%singular)) deallocate (self%singular)
    call self%balance%set_position(self%cluster, geometry, reactions, reactions%length, regular)
    if (regular) return
    call decompose(self)
  end subroutine set_position

  !> Decompose the equations of a position, whose factors do not serve, and prepare those of the next one.
  subroutine decompose(self)
    type(equations_type), intent(inout) :: self           !< the equations; get singular values and vectors

    allocate (self%singular)
    call decompose_cluster(self%cluster, self%balance, self%tolerance, self%singular)
    call self%singular%hold_motions(self%cluster, self%balance)
  end subroutine decompose

  !> Complete wrenches so that the links are in balance; `balanced` is false where they cannot be. Where corrections do not converge,
  !> singular values decide, as they do for the wrenches themselves.
  subroutine complete(self, required, wrenches, balanced, displacements, size_of_all)
    class(equations_type), intent(inout) :: self             !< the equations
    real(wp), intent(in), contiguous :: required(:, :)       !< (6,nodes) scaled
    real(wp), intent(inout), contiguous :: wrenches(:, :)    !< (6,pairs) scaled
    logical, intent(out) :: balanced                         !< the links are in balance
    real(wp), intent(out) :: displacements(:, :)             !< (6,nodes) that belong to the wrenches, scaled
    real(wp), intent(in), optional :: size_of_all            !< by which balance is judged where wrenches are smaller
    real(wp) :: lacking(size(required, 1), size(required, 2)), given(size(wrenches, 1), size(wrenches, 2))

    if (.not. allocated(self%singular)) then
      given = wrenches
      call self%balance%complete(required, wrenches, lacking, balanced, displacements, size_of_all)
      if (balanced) return
      wrenches = given
      call decompose(self)
    end if
    call self%singular%complete(self%balance, required, wrenches, balanced, displacements, size_of_all)
  end subroutine complete

  !> Remove from wrenches the part that the balance of the links and the loads on coordinates determine.
  subroutine remove_determined(self, wrenches)
    class(equations_type), intent(inout) :: self             !< the equations
    real(wp), intent(inout), contiguous :: wrenches(:, :)    !< (6,pairs) scaled
    integer :: i

    associate (balance => self%balance)
      do i = 1, size(wrenches, 2)
        if (balance%held(i)) &
          wrenches(:, i) = wrenches(:, i) - dot_product(balance%axis(:, i), wrenches(:, i))*balance%axis(:, i)
      end do
      if (allocated(self%singular)) then
        call self%singular%remove_determined(wrenches)
      else
        call balance%remove_determined(wrenches)
      end if
    end associate
  end subroutine remove_determined

  !> Find the derivatives of the wrenches of a cluster. `regular` is false beside a singular position.
  subroutine vary_cluster(reactions, position, equations, force, moment, regular)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(varied_position_type), intent(in) :: position       !< with its derivatives
    type(equations_type), intent(inout) :: equations         !< of the cluster; gets those of the position
    real(wp), intent(inout) :: force(:, :, :)                !< (P,3,M) gets the derivatives of the cluster's pairs [N per unit]
    real(wp), intent(inout) :: moment(:, :, :)               !< (P,3,M) about the points of the joints' last pairs [N m per unit]
    logical, intent(out) :: regular                          !< the wrenches have derivatives
    real(wp) :: changes(6, size(equations%cluster%pairs)), length, other
    integer :: p, i

    call equations%set_position(reactions, position%geometry)
    call find_balance(reactions, position, equations, regular)
    do p = 1, size(position%links%alongs, 1)
      if (.not. regular) return
      length = position%changes%length(p)
      other = position%changes%other_length(p)
      call vary_balance(reactions, position, change_type(p, length, position%sizes(p)), equations, changes, regular)
      if (abs(other - length) > equal_lengths*max(abs(length), position%sizes(p)*reactions%length)) &
        call keep_common(reactions, position, other - length, equations, changes, regular)
      associate (pairs => equations%cluster%pairs)
        do i = 1, size(pairs)
          force(p, :, pairs(i)) = changes(1:3, i)
          moment(p, :, pairs(i)) = changes(4:6, i)
        end do
      end associate
    end do
  end subroutine vary_cluster

  !> The wrenches, displacements and forces in the present position.
  subroutine find_balance(reactions, position, equations, regular)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(varied_position_type), intent(in) :: position       !< the position
    type(equations_type), intent(inout) :: equations         !< of the position; get its balance
    logical, intent(out) :: regular                          !< the links are in balance
    real(wp), dimension(6, size(equations%cluster%links)) :: required, displacements
    real(wp) :: wrenches(6, size(equations%cluster%pairs)), largest
    integer :: i

    wrenches = 0.0_wp
    associate (cluster => equations%cluster, balance => equations%balance, links => position%links)
      do i = 1, size(cluster%links)
        required(:, i) = at_place(links%wrench(:, cluster%links(i)), position%geometry%place(:, cluster%links(i)), reactions%length)
      end do
      do i = 1, size(cluster%pairs)
        if (balance%held(i)) wrenches(:, i) = links%along(cluster%pairs(i)) &
                                              /length_of(reactions, position%changes, cluster%pairs(i))*balance%axis(:, i)
      end do
      largest = largest_of(reactions, equations, position%changes, links%largest)
    end associate
    call equations%complete(required, wrenches, regular, displacements, largest)
    associate (present => equations%present, balance => equations%balance)
      present%wrenches = wrenches
      present%largest = max(largest, maxval(abs(wrenches)))
      if (.not. allocated(present%motions)) allocate (present%motions(6, size(wrenches, 2)), present%along(size(wrenches, 2)))
      do i = 1, size(wrenches, 2)
        present%motions(:, i) = balance%find_motion(i, displacements)
        present%along(i) = 0.0_wp
        if (balance%held(i)) present%along(i) = dot_product(balance%axis(:, i), wrenches(:, i)/balance%parts(i) &
                                                            - present%motions(:, i))
      end do
    end associate
  end subroutine find_balance

  !> The length of the screw of a pair [m per unit].
  pure real(wp) function length_of(reactions, varied, k)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(varied_geometry_type), intent(in) :: varied         !< with the screws of the pairs
    integer, intent(in) :: k                                 !< coordinate of the pair

    associate (screw => varied%screw(:, k))
      length_of = norm2([screw(1:3), reactions%length*screw(4:6)])
    end associate
  end function length_of

  !> The largest of the forces that act along the dependent coordinates of a cluster, scaled.
  pure real(wp) function largest_of(reactions, equations, varied, forces) result(largest)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(equations_type), intent(in) :: equations            !< of the cluster
    type(varied_geometry_type), intent(in) :: varied         !< with the screws of the pairs
    real(wp), intent(in) :: forces(:)                        !< (M) the forces, or derivatives of them [N m, N]
    integer :: i

    largest = 0.0_wp
    associate (pairs => equations%cluster%pairs)
      do i = 1, size(pairs)
        if (equations%balance%held(i)) largest = max(largest, forces(pairs(i))/length_of(reactions, varied, pairs(i)))
      end do
    end associate
  end function largest_of

  !> The derivatives of the wrenches by one parameter, for one change of the length by which moments are divided; or by this length
  !> alone.
  subroutine vary_balance(reactions, position, by, equations, changes, regular)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(varied_position_type), intent(in) :: position       !< with its derivatives
    type(change_type), intent(in) :: by                      !< the parameter
    type(equations_type), intent(inout) :: equations         !< of the position, with its balance
    real(wp), intent(out) :: changes(:, :)                   !< (6,pairs) forces [N per unit] and moments [N m per unit]
    logical, intent(out) :: regular                          !< the derivatives are found
    real(wp), dimension(6, size(equations%cluster%pairs)) :: wrenches
    real(wp), dimension(6, size(equations%cluster%links)) :: required, displacements
    real(wp) :: lever(3), largest
    integer :: i

    call vary_lacking(reactions, position, by, equations, required)
    associate (present => equations%present, pairs => equations%cluster%pairs)
      do i = 1, size(pairs)
        ! B'^T y: the point of the pair moves, and moments are divided by another length
        lever = 0.0_wp
        if (by%p > 0) lever = position%changes%point(by%p, :, reactions%pairs(pairs(i))%last)
        wrenches(1:3, i) = cross(present%motions(4:6, i), lever)/reactions%length
        wrenches(4:6, i) = by%longer/reactions%length*present%motions(4:6, i)
        if (equations%balance%held(i)) then
          call vary_held(reactions, position, by, equations, i, wrenches(:, i))
        else
          wrenches(:, i) = equations%balance%parts(i)*wrenches(:, i)
        end if
      end do
    end associate
    ! derivatives by a parameter that hardly matters are round-off of the wrenches
    largest = by%size*equations%present%largest
    if (by%p > 0) &
      largest = max(largest, largest_of(reactions, equations, position%changes, position%links%largest_changes(by%p, :)))
    call equations%complete(required, wrenches, regular, displacements, largest)
    changes(1:3, :) = wrenches(1:3, :)
    changes(4:6, :) = reactions%length*wrenches(4:6, :) + by%longer*equations%present%wrenches(4:6, :)
  end subroutine vary_balance

  !> The wrench b' - B' r that each link requires from the changes of the wrenches, scaled.
  pure subroutine vary_lacking(reactions, position, by, equations, required)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(varied_position_type), intent(in) :: position       !< with its derivatives
    type(change_type), intent(in) :: by                      !< the parameter
    type(equations_type), intent(in) :: equations            !< of the position, with its balance
    real(wp), intent(out) :: required(:, :)                  !< (6,nodes)
    real(wp) :: sums(6, size(equations%cluster%links)), point(3), moment(3)
    integer :: i, side

    sums = 0.0_wp
    point = 0.0_wp
    associate (cluster => equations%cluster, wrenches => equations%present%wrenches)
      do i = 1, size(cluster%links)
        if (by%p > 0) sums(:, i) = position%links%wrenches(by%p, :, cluster%links(i))
      end do
      do i = 1, size(cluster%pairs)
        ! a wrench of the same scaled numbers changes about the origin as its point moves and the length changes
        if (by%p > 0) point = position%changes%point(by%p, :, reactions%pairs(cluster%pairs(i))%last)
        moment = by%longer*wrenches(4:6, i) + cross(point, wrenches(1:3, i))
        do side = 1, 2
          if (cluster%nodes(side, i) == 0) cycle
          associate (sum => sums(1:3, cluster%nodes(side, i)))
            sum = sum + (2*side - 3)*moment
          end associate
        end do
      end do
      do i = 1, size(cluster%links)
        required(:, i) = at_place(sums(:, i), position%geometry%place(:, cluster%links(i)), reactions%length)
      end do
    end associate
  end subroutine vary_lacking

  !> The part of the change of a wrench that the load on its dependent coordinate determines, with the right-hand side across its axis.
  pure subroutine vary_held(reactions, position, by, equations, i, change)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(varied_position_type), intent(in) :: position       !< with the loads, and derivatives of the screws
    type(change_type), intent(in) :: by                      !< the parameter
    type(equations_type), intent(in) :: equations            !< of the position, with its balance
    integer, intent(in) :: i                                 !< place of the pair in the cluster
    real(wp), intent(inout) :: change(6)                     !< B'^T y; gets the change, as far as it is known
    real(wp) :: screw_change(6), axis_change(6), length, length_change, along_change, held
    integer :: k

    k = equations%cluster%pairs(i)
    length = length_of(reactions, position%changes, k)
    screw_change(1:3) = 0.0_wp
    screw_change(4:6) = by%longer*position%changes%screw(4:6, k)
    along_change = 0.0_wp
    if (by%p > 0) then
      screw_change(1:3) = position%changes%screw_change(by%p, 1:3, k)
      screw_change(4:6) = screw_change(4:6) + reactions%length*position%changes%screw_change(by%p, 4:6, k)
      along_change = position%links%alongs(by%p, k)
    end if
    ! N, the screw of length 1; r and m
    associate (axis => equations%balance%axis(:, i), wrench => equations%present%wrenches(:, i), &
               along => equations%present%along(i))
      length_change = dot_product(axis, screw_change)
      axis_change = (screw_change - length_change*axis)/length
      held = (along_change - position%links%along(k)*length_change/length)/length - dot_product(axis_change, wrench)
      change = change + along*axis_change
      change = held*axis + equations%balance%parts(i)*(change - dot_product(axis, change)*axis)
    end associate
  end subroutine vary_held

  !> A wrench about the origin of frame 0 as a scaled one about a place: force, then moment over the length.
  pure function at_place(wrench, place, length) result(scaled)
    real(wp), intent(in) :: wrench(6)   !< moment, force [N m, N]
    real(wp), intent(in) :: place(3)    !< from the origin of frame 0 [m]
    real(wp), intent(in) :: length      !< by which moments are divided [m]
    real(wp) :: scaled(6)

    scaled(1:3) = wrench(4:6)
    scaled(4:6) = (wrench(1:3) - cross(place, wrench(4:6)))/length
  end function at_place

  !> Keep the components that do not depend on the change of the length by which moments are divided. The others have no derivative:
  !> NaN. What the length alone changes balances nothing, so that the part that equilibrium determines is round-off. It is taken
  !> off: beside a singular position it is large, and derivatives are so much larger that their differences would mean nothing.
  subroutine keep_common(reactions, position, longer, equations, changes, regular)
    type(reaction_plan_type), intent(in) :: reactions        !< the plan of inverse dynamics
    type(varied_position_type), intent(in) :: position       !< with its derivatives
    real(wp), intent(in) :: longer                           !< difference of two derivatives of the length [m per unit]
    type(equations_type), intent(inout) :: equations         !< of the position, with its balance
    real(wp), intent(inout) :: changes(:, :)                 !< (6,pairs) forces [N per unit] and moments [N m per unit]
    logical, intent(out) :: regular                          !< the derivatives are found
    real(wp) :: differences(6, size(equations%cluster%pairs)), least

    call vary_balance(reactions, position, change_type(0, longer, abs(longer)/reactions%length), equations, differences, regular)
    differences(4:6, :) = differences(4:6, :)/reactions%length
    call equations%remove_determined(differences)
    least = equal_lengths*abs(longer)/reactions%length*maxval(abs(equations%present%wrenches))
    where (abs(differences) > least) changes = ieee_value(1.0_wp, ieee_quiet_nan)
  end subroutine keep_common
end module mech9_varied_cluster
