!> The motion of designs side by side, compiled for the vectors of AVX-512.
module mech9_lane_motion_avx512
  use mech9_kinds, only: wp
  use mech9_tolerances, only: last_correction, longest_move, near_singular, trusted_change, trusted_correction, trusted_rate_change
  use mech9_motion_tolerances, only: small_turn
  use mech9_tracking_tolerances, only: far_slide, harmless_change, longest_prediction, round_off_term, small_correction, &
    trusted_contraction
  use mech9_sine_cosine, only: largest_angle, per_quarter, quarter, whole
  use mech9_lane_group, only: lane_group_type, lane_step_type, lanes
  use mech9_lane_tolerances, only: clear_start, closed, least_square, least_volume, longest_change, most_iterations, small_sine
  implicit none
  private
  public :: begin_in_lanes, go_on_in_lanes, renew_rates_in_lanes, point_in_lanes, keep_in_lanes

contains

  include 'lane_motion.inc'

  include 'lane_frames.inc'

  include 'lane_judgement.inc'
end module mech9_lane_motion_avx512
