// Times the functions that generated.py writes: the best of many batches at 256 random states, ns per evaluation.
#include "generated.c"

#include "batches.hpp"

typedef int (*Function)(const casadi_real **, casadi_real **, casadi_int *, casadi_real *, int);

int main() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-3, 3);
  const std::size_t states = 256;
  std::vector<double> numbers(18 * states), out(6 * 60);
  for (auto &number : numbers) number = unit(random);
  const std::pair<const char *, Function> functions[] = {{"CasADi, regressor", regressor}, {"CasADi, RNEA", rnea}, {"CasADi, ABA", aba}};
  std::vector<double> work(1 << 16);
  std::vector<casadi_int> indices(1 << 12);
  for (const auto &[name, function] : functions)
    time(name, states, [&](std::size_t k) {
      const double *arguments[] = {&numbers[18 * k], &numbers[18 * k + 6], &numbers[18 * k + 12]};
      double *results[] = {out.data()};
      function(arguments, results, indices.data(), work.data(), 0);
      sink = out[0];
    });
}
