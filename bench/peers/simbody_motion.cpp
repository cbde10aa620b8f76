// A motion by Simbody, for simbody_motion.py: reads a mechanism as numbers, integrates it, and prints seconds, evaluations of the
// motion, and the coordinates at the end.
//
// Input: the time of the end [s], the accuracy, gravity [m/s2]; then lines, each with a word:
//   body    mass centre[3] moments[3]
//   joint   turns(0|1) reference moving point[3] moving_point[3] axis[3] position rate
//   ball    link point[3] link point[3]
//   spring  link point[3] link point[3] stiffness damping free_length
//   torque  link torque[3]
//   end
// Links have the numbers of the data file, from 1, the frame; a body belongs to the joint that follows it.
#include <chrono>
#include <iostream>
#include <map>
#include <vector>

#include <Simbody.h>

using namespace SimTK;

static Vec3 vector() {
  Vec3 v;
  std::cin >> v[0] >> v[1] >> v[2];
  return v;
}

int main() {
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  GeneralForceSubsystem forces(system);
  Real end, accuracy;
  std::cin >> end >> accuracy;
  Force::UniformGravity(forces, matter, vector());

  std::map<int, MobilizedBody> links;
  links[1] = matter.Ground();
  std::vector<int> moved;
  std::vector<Real> positions, rates;
  MassProperties mass;
  std::string word;
  while (std::cin >> word && word != "end") {
    if (word == "body") {
      Real m;
      std::cin >> m;
      const Vec3 centre = vector(), moments = vector();
      mass = MassProperties(m, centre, Inertia(moments).shiftFromMassCenter(centre, m));
    } else if (word == "joint") {
      bool turns;
      int reference, moving;
      std::cin >> turns >> reference >> moving;
      const Vec3 point = vector(), moving_point = vector(), axis = vector();
      // pins turn about z, sliders move along x
      const Rotation rotation(UnitVec3(axis), turns ? CoordinateAxis(ZAxis) : CoordinateAxis(XAxis));
      const Transform inboard(rotation, point), outboard(rotation, moving_point);
      const Body::Rigid body(mass);
      if (turns)
        links[moving] = MobilizedBody::Pin(links[reference], inboard, body, outboard);
      else
        links[moving] = MobilizedBody::Slider(links[reference], inboard, body, outboard);
      Real position, rate;
      std::cin >> position >> rate;
      moved.push_back(moving);
      positions.push_back(position);
      rates.push_back(rate);
    } else {
      int first, second;
      std::cin >> first;
      const Vec3 v = vector();
      if (word == "torque") {
        Force::ConstantTorque(forces, links[first], v);
        continue;
      }
      std::cin >> second;
      const Vec3 w = vector();
      if (word == "ball") {
        Constraint::Ball(links[first], v, links[second], w);
      } else {
        Real stiffness, damping, length;
        std::cin >> stiffness >> damping >> length;
        Force::TwoPointLinearSpring(forces, links[first], v, links[second], w, stiffness, length);
        if (damping != 0) Force::TwoPointLinearDamper(forces, links[first], v, links[second], w, damping);
      }
    }
  }

  system.realizeTopology();
  State state = system.getDefaultState();
  for (std::size_t i = 0; i < moved.size(); i++) {
    links[moved[i]].setOneQ(state, 0, positions[i]);
    links[moved[i]].setOneU(state, 0, rates[i]);
  }
  try {
    RungeKuttaMersonIntegrator integrator(system);
    integrator.setAccuracy(accuracy);
    const auto begin = std::chrono::steady_clock::now();
    integrator.initialize(state);
    while (integrator.getTime() < end) integrator.stepTo(end);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    std::cout.precision(17);
    std::cout << spent.count() << ' ' << integrator.getNumRealizations();
    for (int link : moved) std::cout << ' ' << links[link].getOneQ(integrator.getState(), 0);
    std::cout << std::endl;
  } catch (const std::exception& failure) {
    std::cerr << failure.what() << std::endl;
    return 1;
  }
}
