// The fastest of many batches: what the machine does when nothing else runs on it.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

static volatile double sink = 0;

template <class F> static void time(const char *name, std::size_t states, F run) {
  double best = 1e9;
  for (int batch = 0; batch < 2000; ++batch) {
    auto began = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < states; ++k) run(k);
    std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    best = std::min(best, took.count() / static_cast<double>(states));
  }
  std::printf("%-52s %8.1f ns\n", name, best * 1e9);
}
