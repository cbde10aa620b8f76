"""Mechanisms in the words of MuJoCo. Chains are closed by its soft constraints, as hard as it lets them be."""


def words(numbers):
    return ' '.join(repr(float(number)) for number in numbers)


def model_of(mujoco, mechanism, ends, springs=False, option='', closure=''):
    """The model, and the pairs of its joints in their order. `ends`: points that meet where chains are closed; `springs`: springs as
    tendons; `option`, `closure`: attributes of <option> and of <connect>."""
    children, sites, tendons = {}, [], []
    for k in mechanism.tree:
        children.setdefault(mechanism.pairs[k].reference, []).append(k)
    for i, (reference, point, moving, moving_point) in enumerate(ends):
        sites += [(reference, f'a{i}', point), (moving, f'b{i}', moving_point)]
    if springs:
        for i, spring in enumerate(mechanism.springs):
            sites += [(int(spring['links'][0]), f'c{i}', spring['position']), (int(spring['links'][1]), f'd{i}', spring['second_position'])]
            tendons.append(f'<spatial stiffness="{spring["stiffness"][0]!r}" damping="{spring.get("damping", [0.0])[0]!r}" '
                           f'springlength="{spring["free_length"][0]!r}"><site site="c{i}"/><site site="d{i}"/></spatial>')
    # nested as the links are; without recursion, since chains are long
    text, stack = [], [('open', 1, None)]
    while stack:
        action, link, k = stack.pop()
        if action == 'close':
            text.append('</body>')
            continue
        if k is not None:
            pair = mechanism.pairs[k]
            text.append(f'<body pos="{words(p - m for p, m in zip(pair.point, pair.moving_point))}">'
                        f'<joint type="{"hinge" if pair.turns else "slide"}" pos="{words(pair.moving_point)}" axis="{words(pair.axis)}"/>')
            mass, centre, inertia = mechanism.bodies[link]
            # it wants three moments above zero: those of thin rods about their own axis, which nothing turns, are as large as the others
            moments = [moment or max(inertia[:3]) for moment in inertia[:3]]
            text.append(f'<inertial mass="{mass!r}" pos="{words(centre)}" diaginertia="{words(moments)}"/>')
            stack.append(('close', link, None))
        text += [f'<site name="{name}" pos="{words(point)}"/>' for on, name, point in sites if on == link]
        stack += [('open', mechanism.pairs[c].moving, c) for c in reversed(children.get(link, []))]
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option gravity="{words(mechanism.gravity)}" {option}><flag contact="disable"/></option>'
        f'<worldbody>{"".join(text)}</worldbody><tendon>{"".join(tendons)}</tendon><equality>'
        + ''.join(f'<connect site1="a{i}" site2="b{i}" solimp="0.9999 0.9999 0.001 0.5 2" {closure}/>' for i in range(len(ends)))
        + '</equality></mujoco>')
    # joints are numbered in the order of the text
    return model, list(depth_first(mechanism, children))


def depth_first(mechanism, children):
    """Pairs of the tree in the order in which nested text has them."""
    stack = list(reversed(children[1]))
    while stack:
        k = stack.pop()
        yield k
        stack += reversed(children.get(mechanism.pairs[k].moving, []))
