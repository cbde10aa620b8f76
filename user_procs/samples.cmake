# The programs of all samples, by mech9_add_programs: one line each, as in a project of your own.
function(mech9_add_samples folder)
  mech9_add_programs(NAME trammel PROCEDURES ${folder}/trammel/trammel.f90)
  mech9_add_programs(NAME trammel_values PROCEDURES ${folder}/trammel/trammel_values.f90)
  mech9_add_programs(NAME cam_follower PROCEDURES ${folder}/cam_follower/cam_follower.f90 ${folder}/cam_follower/oldcam.f)
  mech9_add_programs(NAME cycloidal_drive PROCEDURES ${folder}/cycloidal_drive/cycloidal_drive.f90)
  mech9_add_programs(NAME cycloidal_drive_values PROCEDURES ${folder}/cycloidal_drive/cycloidal_drive_values.f90)
  mech9_add_programs(NAME air_drag PROCEDURES ${folder}/air_drag/air_drag.f90)
endfunction()
