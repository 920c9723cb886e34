// Pinocchio's joint-torque regressor, RNEA and ABA of the CRS A460, compiled for this processor from its headers: the best of
// many batches at 256 random states, ns per evaluation. See README.md for the commands.
#include <cmath>

#include "batches.hpp"

#include <pinocchio/fwd.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace pin = pinocchio;

// Offset deg, d m, a m, alpha deg: models/crs-a460/robot.toml.
static const double DH[6][4] = {{0, 0.3302, 0, 90},  {90, 0, 0.3048, 0}, {-90, 0, 0, -90},
                                {0, 0.3302, 0, 90}, {0, 0, 0, -90},     {0, 0.0762, 0, 0}};

static pin::SE3 turn(const Eigen::Vector3d &axis, double degrees, const Eigen::Vector3d &p) {
  return pin::SE3(Eigen::AngleAxisd(degrees * M_PI / 180, axis).toRotationMatrix(), p);
}

int main() {
  pin::Model model;
  pin::JointIndex parent = 0;
  pin::SE3 after = pin::SE3::Identity();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  for (const auto &row : DH) {
    parent = model.addJoint(parent, pin::JointModelRZ(), after * turn(z, row[0], Eigen::Vector3d::Zero()), "joint" + std::to_string(parent + 1));
    model.appendBodyToJoint(parent, pin::Inertia::Random(), pin::SE3::Identity());
    after = turn(z, 0, Eigen::Vector3d(row[2], 0, row[1])) * turn(x, row[3], Eigen::Vector3d::Zero());
  }
  pin::Data data(model);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::size_t states = 256;
  std::vector<Eigen::VectorXd> q(states), v(states), a(states);
  for (std::size_t k = 0; k < states; ++k)
    for (auto *of : {&q[k], &v[k], &a[k]}) {
      of->resize(6);
      for (int i = 0; i < 6; ++i) (*of)[i] = 3 * unit(random);
    }
  time("Pinocchio, regressor", states, [&](std::size_t k) { sink = pin::computeJointTorqueRegressor(model, data, q[k], v[k], a[k])(0, 0); });
  time("Pinocchio, RNEA", states, [&](std::size_t k) { sink = pin::rnea(model, data, q[k], v[k], a[k])[0]; });
  time("Pinocchio, ABA", states, [&](std::size_t k) { sink = pin::aba(model, data, q[k], v[k], a[k])[0]; });
}
