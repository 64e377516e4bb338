#include "bench/transfer/link_direction.h"

#include <cstdio>

int main() {
  const auto problem = gs::bench::test_link_direction();
  std::fprintf(stderr, "the emulated link %s\n", problem ? problem->c_str() : "does what it should");
  return problem ? 1 : 0;
}
