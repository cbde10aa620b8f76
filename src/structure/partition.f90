!> The partition of the coordinates into driven, free and dependent ones, with the order of computation that follows from it.
module mech9_partition
  use mech9_structure, only: structure_type
  use mech9_structural_vectors, only: structural_vectors_type
  use mech9_transformation, only: transform
  implicit none
  private
  public :: partition_type, new_partition, dependent_coordinate, free_coordinate, driven_coordinate

  integer, parameter :: dependent_coordinate = 0   !< the closed chains determine it
  integer, parameter :: free_coordinate = 1        !< independent; its motion follows from the forces
  integer, parameter :: driven_coordinate = 2      !< independent; a drive gives its motion

  type :: partition_type
    integer, allocatable :: kind(:)              !< (M) one of the kinds above for each coordinate
    type(structural_vectors_type) :: vectors     !< the order of computation, from the data file or made from the structure
  contains
    procedure :: is_independent
    procedure :: independent
    procedure :: driven
    procedure :: with_independent
    procedure :: in_same_order
  end type partition_type

contains

  !> A partition whose independent coordinates are all free, with the order of computation that the structure gives.
  pure subroutine new_partition(structure, independent, partition)
    type(structure_type), intent(in) :: structure    !< the links of each pair, without findings
    logical, intent(in) :: independent(:)            !< (M) the coordinate is independent
    type(partition_type), intent(out) :: partition   !< the partition

    partition%kind = merge(free_coordinate, dependent_coordinate, independent)
    call transform(structure, independent, partition%vectors)
  end subroutine new_partition

  !> Whether a coordinate is driven or free.
  pure logical function is_independent(self, coordinate)
    class(partition_type), intent(in) :: self   !< the partition
    integer, intent(in) :: coordinate           !< number of the coordinate

    is_independent = self%kind(coordinate) /= dependent_coordinate
  end function is_independent

  !> Whether each coordinate is driven or free.
  pure function independent(self)
    class(partition_type), intent(in) :: self   !< the partition
    logical :: independent(size(self%kind))

    independent = self%kind /= dependent_coordinate
  end function independent

  !> Whether a drive gives the motion of each coordinate.
  pure function driven(self)
    class(partition_type), intent(in) :: self   !< the partition
    logical :: driven(size(self%kind))

    driven = self%kind == driven_coordinate
  end function driven

  !> The partition with other independent coordinates. Those that are driven now stay driven.
  pure subroutine with_independent(self, structure, independent, other)
    class(partition_type), intent(in) :: self       !< the partition
    type(structure_type), intent(in) :: structure   !< the links of each pair
    logical, intent(in) :: independent(:)           !< (M) the coordinate is independent
    type(partition_type), intent(out) :: other      !< the other partition

    call new_partition(structure, independent, other)
    where (independent .and. self%kind == driven_coordinate) other%kind = driven_coordinate
  end subroutine with_independent

  !> The partition with other independent coordinates in the same order of computation: its chains are those of the first
  !> choice. Coordinates that are driven now stay driven.
  pure function in_same_order(self, independent) result(other)
    class(partition_type), intent(in) :: self   !< the partition
    logical, intent(in) :: independent(:)       !< (M) the coordinate is independent
    type(partition_type) :: other

    other%vectors = self%vectors
    other%kind = merge(free_coordinate, dependent_coordinate, independent)
    where (independent .and. self%kind == driven_coordinate) other%kind = driven_coordinate
  end function in_same_order
end module mech9_partition
