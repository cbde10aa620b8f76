!> The library for other programs: mechanisms from data files or from values set in code, and their motions
!> (docs/how-to/library.md).
!>
!> Angles are in rad, lengths in m, times in s, whatever units a data file uses. Nothing is printed and no program is ended: a
!> failure is a value `type(error_type), allocatable`, whose message tells what is wrong and what to do. Threads may run motions
!> of their own at the same time.
module mech9
  use mech9_kinds, only: wp
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_text, only: string_type
  use mech9_error, only: error_type, exit_usage, exit_data, exit_structure, exit_assembly, exit_singular, exit_integrator, &
    exit_file, exit_interrupted
  use mech9_simulation, only: interruption_type, simulation_statistics_type, coordinate_change_type
  use mech9_motion_event, only: motion_event_type
  use mech9_motion_view, only: motion_view_type
  use mech9_force_sum, only: force_sum_type
  use mech9_findings, only: finding_type
  use mech9_checked_mechanism, only: mechanism_type => checked_mechanism_type, &
    read_file, read_text, parse_file, parse_text
  use mech9_design, only: design_type
  use mech9_motion, only: motion_type
  use mech9_recorded_run, only: run_type => recorded_run_type
  use mech9_recorded_study, only: study_type => recorded_study_type
  use mech9_recorded_rest, only: rest_type => recorded_rest_type
  use mech9_recorded_linear, only: linear_system_type, find_linear_system, linear_along_type, find_linear_along
  use mech9_recorded_branches, only: find_position_branches
  use mech9_recorded_exponents, only: exponents_found_type, find_motion_exponents
  use mech9_recorded_cam, only: find_cam
  use mech9_recorded_optimum, only: optimum_type => recorded_optimum_type
  use mech9_followed_positions, only: positions_type => followed_positions_type
  use mech9_motion_equations, only: equations_type => motion_equations_type
  use mech9_drawn_mechanism, only: draw_sketch, draw_film
  use mech9_structure_answers, only: judge_mobility, list_assemblies, list_ranges, name_coordinates, report_parts
  implicit none
  private
  public :: wp, kinematics, dynamics, string_type
  public :: mechanism_type, finding_type, read_file, read_text, parse_file, parse_text, design_type
  public :: motion_type, run_type, study_type, rest_type, optimum_type, positions_type, equations_type, linear_system_type, &
    linear_along_type, exponents_found_type
  public :: motion_view_type, force_sum_type
  public :: interruption_type, simulation_statistics_type, coordinate_change_type, motion_event_type
  public :: judge_mobility, list_assemblies, list_ranges, name_coordinates, report_parts, find_linear_system, find_linear_along, &
    find_motion_exponents, find_position_branches, find_cam, draw_sketch, draw_film
  public :: error_type, exit_usage, exit_data, exit_structure, exit_assembly, exit_singular, exit_integrator, exit_file, &
    exit_interrupted
end module mech9
