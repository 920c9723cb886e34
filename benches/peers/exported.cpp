// Times the functions of `armid export --to c`: the best of many batches at 256 random states, ns per evaluation.
extern "C" {
#include "exported.c"
}

#include "batches.hpp"

int main() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-3, 3);
  const std::size_t states = 256;
  std::vector<double> numbers(18 * states), out(6 * 36);
  for (auto &number : numbers) number = unit(random);
  const auto q = [&](std::size_t k) { return &numbers[18 * k]; };
  time("exported, regressor", states, [&](std::size_t k) {
    armid_regressor(q(k), q(k) + 6, q(k) + 12, out.data());
    sink = out[0];
  });
  time("exported, RNEA", states, [&](std::size_t k) {
    armid_inverse_dynamics(q(k), q(k) + 6, q(k) + 12, out.data());
    sink = out[0];
  });
  time("exported, forward dynamics", states, [&](std::size_t k) {
    armid_forward_dynamics(q(k), q(k) + 6, q(k) + 12, out.data());
    sink = out[0];
  });
  time("exported, mass matrix", states, [&](std::size_t k) {
    armid_mass_matrix(q(k), out.data());
    sink = out[0];
  });
}
