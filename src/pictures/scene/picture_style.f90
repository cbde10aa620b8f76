!> The style of pictures: colours, widths, and the marks of joints and points.
!>
!> The colours are those of Okabe and Ito, which people with any kind of colour vision can distinguish. Each has a light
!> tint, and outlines are dark, so that pictures can also be read in grey.
module mech9_picture_style
  use mech9_kinds, only: wp, pi
  use mech9_xml_text, only: decimal
  use mech9_scene, only: in_cam, as_stand, as_ring, as_ball, as_dot, as_centre, as_free, as_leader, in_damper, as_coil, as_cup, &
    in_force, in_bracket, as_stuck, in_velocity, in_rolling, as_sphere, in_target, as_pole, in_moment, in_touching
  implicit none
  private
  public :: style_type, styles, dark_colours, light_colours, signal, light_signal, colour_of, ink, style_sheet, mark_svg, &
            coil_corners, cup_corners

  character(len=7), parameter :: ink = '#222222', ground = '#555555', paper = '#ffffff'
  !> The colours of links, which take them in turn.
  character(len=7), parameter :: dark_colours(*) = [ &
    '#0072b2', '#b04a00', '#00785a', '#a0457a', '#2f7fb5', '#8a6400', '#5a5a5a']
  character(len=7), parameter :: light_colours(*) = [ &
    '#a9d4ee', '#f7c29b', '#a3dec9', '#ecc4da', '#d6ecfa', '#f7dd8f', '#d9d9d9']

  !> The colours of what holds a coordinate in a frame of a film: a stop that pushes, or a pair that sticks.
  character(len=7), parameter :: signal = '#d0001f', light_signal = '#ff8a8a'

  !> The style in which an item is drawn. A style with an edge is a band: a line of its width in the light colour. An
  !> edge of the dark colour is on both sides.
  type :: style_type
    character(len=12) :: name = ''
    character(len=7) :: colour = ''       !< colour of the line; empty: the dark colour of the link
    real(wp) :: width = 1.0_wp            !< [px]
    logical :: has_edge = .false.
    logical :: butt = .false.             !< the ends are cut at right angles, not round
    character(len=8) :: dashes = ''       !< [px]
  end type style_type

  !> The styles by the numbers of mech9_scene. Marks and labels have only a name here.
  type(style_type), parameter :: styles(*) = [ &
    style_type('trace', '', 1.5_wp), &
    style_type('curve', '', 1.2_wp, dashes='5 3'), &
    style_type('guide', ground, 1.0_wp, dashes='9 3 2 3'), &
    style_type('ground', ink, 1.5_wp), &
    style_type('hatch', ground, 1.0_wp), &
    style_type('plate', '', 7.0_wp, .true.), &
    style_type('block', '', 15.0_wp, .true., .true.), &
    style_type('tube', '', 12.0_wp, .true., .true.), &
    style_type('pin', ink, 10.0_wp, .true., .true.), &
    style_type('end', ink, 1.2_wp), &
    style_type('spring', ink, 1.4_wp), &
    style_type('thread', ink, 1.0_wp), &
    style_type('cross', ink, 3.2_wp, .true.), &
    style_type('cam', '', 0.5_wp, .true.), &
    style_type('stand'), style_type('ring'), style_type('ball'), style_type('dot'), style_type('centre'), &
    style_type('free'), style_type('name'), style_type('number'), style_type('coordinate'), &
    style_type('input'), style_type('leader'), style_type('damper', ink, 1.4_wp), style_type('coil'), style_type('cup'), &
    style_type('force', '#c00000', 2.2_wp), style_type('stop', '', 3.0_wp, .true.), &
    style_type('pushed', signal, 3.0_wp, .true.), style_type('bracket', '', 1.5_wp), style_type('stuck'), &
    style_type('velocity', '#1a7a1a', 2.2_wp), style_type('acceleration', '#7a1fa2', 2.2_wp), style_type('surface', '', 1.2_wp), &
    style_type('rolling', '', 1.1_wp), style_type('sphere'), style_type('target', '#a00000', 1.8_wp), &
    style_type('pole'), style_type('moment', '#c00000', 2.2_wp), style_type('load', '#0033cc', 2.2_wp), &
    style_type('weight', ink, 2.2_wp), style_type('touching', '#b35900', 2.2_wp)]

  !> The width of an edge [px].
  real(wp), parameter, public :: edge = 1.2_wp

contains

  !> The number of the colour of a link.
  pure integer function colour_of(link)
    integer, intent(in) :: link  !< number of the link

    colour_of = 1 + modulo(link - 2, size(dark_colours))
  end function colour_of

  !> The style sheet of a picture.
  pure function style_sheet(symbol) result(css)
    real(wp), intent(in) :: symbol  !< scale of symbols, 1 at full size
    character(len=:), allocatable :: css
    character(len=*), parameter :: nl = new_line('a')
    integer :: i

    css = 'svg.mech9{font-family:"DejaVu Sans",Verdana,Helvetica,Arial,sans-serif;background:'//paper//'}'//nl// &
          '.mech9 path{fill:none;stroke-linecap:round;stroke-linejoin:round}'//nl// &
          '.mech9 text{fill:'//ink//';font-size:12px;stroke:'//paper//';stroke-width:3px;stroke-linejoin:round;'// &
          'paint-order:stroke}'//nl// &
          '.mech9 .title{font-size:15px;stroke:none}.mech9 .small{font-size:11px;stroke:none}'//nl// &
          '.mech9 .name{font-weight:bold}.mech9 .coordinate{font-size:10px;font-style:italic;fill:#444;text-anchor:end}'//nl// &
          '.mech9 .input{font-size:10px;font-style:italic;font-weight:bold;fill:#b04a00;text-anchor:end}'//nl// &
          '.mech9 .number{font-size:11px;text-anchor:middle;dominant-baseline:central}'//nl
    do i = 1, in_cam
      css = css//rule_of(styles(i), symbol)//nl
    end do
    css = css//rule_of(styles(in_damper), symbol)//nl
    do i = in_force, in_bracket
      css = css//rule_of(styles(i), symbol)//nl
    end do
    do i = in_velocity, in_rolling
      css = css//rule_of(styles(i), symbol)//nl
    end do
    css = css//rule_of(styles(in_target), symbol)//nl
    do i = in_moment, in_touching
      css = css//rule_of(styles(i), symbol)//nl
    end do
    css = css//'.mech9 .plate.sheet path{fill-opacity:.85}.mech9 .end path{fill:#f2f2f2}'//nl
    do i = 1, size(dark_colours)
      css = css//colour_rules('.l'//achar(48 + i), dark_colours(i), light_colours(i))//nl
    end do
    css = css//'.mech9 .pin .i,.mech9 .cross .i{stroke:#d0d0d0}.mech9 .trace path{stroke-opacity:.85}'//nl// &
          '.mech9 .pushed path.i{stroke:'//light_signal//';fill:'//light_signal//'}'// &
          '.mech9 .stuck circle{fill:'//signal//';stroke:'//paper//'}'//nl// &
          '.mech9 .surface path{fill:#7f7f7f;fill-opacity:.15}'// &
          '.mech9 .sphere circle{fill-opacity:.25;stroke:#555;stroke-width:1.2}'//nl// &
          '.mech9 .k{fill:'//ink//';stroke:none}.mech9 .w{fill:'//paper//';stroke:'//ink//';stroke-width:1.5}'//nl// &
          '.mech9 .h{stroke:'//ground//';stroke-width:1}.mech9 .g{stroke:'//ink//';stroke-width:1.5;fill:#e8e8e8}'//nl// &
          '.mech9 .e{stroke:#777;stroke-width:.8}.mech9 .s{stroke:'//ink//';stroke-width:1.4}'//nl
  end function style_sheet

  !> The rule of one style. A band has two lines: the edge, which is drawn first, and the inside.
  pure function rule_of(style, symbol) result(rule)
    type(style_type), intent(in) :: style  !< style of the items of one kind
    real(wp), intent(in) :: symbol         !< scale of symbols, 1 at full size
    character(len=:), allocatable :: rule

    rule = '.mech9 .'//trim(style%name)//' path{stroke-width:'
    if (style%has_edge) then
      rule = rule//decimal(symbol*style%width + 2.0_wp*edge)
    else
      rule = rule//decimal(style%width)
    end if
    if (style%colour /= '') rule = rule//';stroke:'//style%colour
    if (style%dashes /= '') rule = rule//';stroke-dasharray:'//trim(style%dashes)
    if (style%butt) rule = rule//';stroke-linecap:butt'
    rule = rule//'}'
    if (style%has_edge) rule = rule//'.mech9 .'//trim(style%name)//' path.i{stroke-width:'// &
                               decimal(symbol*style%width)//'}'
  end function rule_of

  !> The rules of the colours of one class.
  pure function colour_rules(class, dark, light) result(rules)
    character(len=*), intent(in) :: class  !< selector of the class, with its point
    character(len=*), intent(in) :: dark   !< colour of lines and texts
    character(len=*), intent(in) :: light  !< colour of surfaces
    character(len=:), allocatable :: rules

    rules = '.mech9 '//class//' path{stroke:'//dark//'}.mech9 '//class//' path.i{stroke:'//light//'}'// &
            '.mech9 '//class//'.sheet path.i{fill:'//light//'}.mech9 '//class//' circle{fill:'//dark//';stroke:'// &
            paper//'}.mech9 text'//class//'{fill:'//dark//'}'
  end function colour_rules

  !> The SVG of a mark around the place (0, 0).
  pure function mark_svg(style, direction) result(svg)
    integer, intent(in) :: style          !< number of the mark, one of the as_ numbers of mech9_scene
    real(wp), intent(in) :: direction(2)  !< for a stand, direction from the joint to the ground; for a leading line, its end; for a ball, first
                                          !< its radius [px]
    character(len=:), allocatable :: svg

    select case (style)
    case (as_stand)
      svg = '<path class="g" d="M0 0L-9 15H9Z"/><path class="g" d="M-14 15H14"/>'// &
            '<path class="h" d="M-12 15l-4 6M-6 15l-4 6M0 15l-4 6M6 15l-4 6M12 15l-4 6"/>'
      if (direction(2) < 0.0_wp) svg = '<g transform="scale(1 -1)">'//svg//'</g>'
    case (as_ring)
      svg = '<circle class="w" r="5"/>'
    case (as_ball)
      svg = '<circle class="w" r="7.5" style="fill:#d0d0d0"/><circle cx="-2" cy="-2.4" r="2" fill="'//paper//'"/>'
    case (as_dot)
      svg = '<circle r="3.6"/>'
    case (as_centre)
      svg = '<circle class="w" r="4.6"/>'// &
            '<path class="k" d="M0 0V-4.6A4.6 4.6 0 0 1 4.6 0ZM0 0V4.6A4.6 4.6 0 0 1 -4.6 0Z"/>'
    case (as_free)
      svg = '<path class="w" style="fill:'//paper//'" d="M0 -7L7 0L0 7L-7 0Z"/><circle class="k" r="2"/>'
    case (as_stuck)
      svg = '<circle r="4"/>'
    case (as_sphere)
      svg = '<circle r="'//decimal(direction(1))//'"/>'
    case (as_pole)
      svg = '<circle class="w" r="4"/><path class="s" d="M-9 0H9M0 -9V9"/>'
    case (as_leader)
      svg = '<path class="e" d="M0 0L'//decimal(direction(1))//' '//decimal(direction(2))//'"/>'
    case (as_coil)
      svg = '<path class="s" d="'//line_through(coil_corners())//'"/>'
    case (as_cup)
      svg = '<path class="s" d="M0 0V-14'//line_through(cup_corners())//'"/>'
    case default
      svg = ''
    end select
  end function mark_svg

  !> The corners of a spiral spring around a joint [px].
  pure function coil_corners() result(corners)
    real(wp) :: corners(2, 41)
    real(wp), parameter :: inner = 7.0_wp, outer = 13.0_wp, turns = 2.25_wp
    real(wp) :: part, angle
    integer :: i

    do i = 1, size(corners, 2)
      part = (i - 1.0_wp)/(size(corners, 2) - 1)
      angle = 2.0_wp*pi*turns*part
      corners(:, i) = (inner + part*(outer - inner))*[cos(angle), -sin(angle)]
    end do
  end function coil_corners

  !> The corners of the cup of a damper that turns about a joint: an arc above the joint, closed on both sides [px].
  pure function cup_corners() result(corners)
    real(wp) :: corners(2, 15)
    real(wp), parameter :: inner = 10.0_wp, outer = 17.0_wp, half = 0.35_wp*pi
    real(wp) :: angle
    integer :: i

    do i = 1, size(corners, 2)
      angle = 0.5_wp*pi + half*(1.0_wp - 2.0_wp*max(0.0_wp, min(12.0_wp, i - 2.0_wp))/12.0_wp)
      corners(:, i) = outer*[cos(angle), -sin(angle)]
    end do
    corners(:, 1) = inner/outer*corners(:, 2)
    corners(:, size(corners, 2)) = inner/outer*corners(:, size(corners, 2) - 1)
  end function cup_corners

  !> The path data of lines through corners.
  pure function line_through(corners) result(path)
    real(wp), intent(in) :: corners(:, :)  !< (2,n) corners of the path [px]
    character(len=:), allocatable :: path
    integer :: i

    path = ''
    do i = 1, size(corners, 2)
      path = path//merge('M', 'L', i == 1)//decimal(corners(1, i))//' '//decimal(corners(2, i))
    end do
  end function line_through
end module mech9_picture_style
