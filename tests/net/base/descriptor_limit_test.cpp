#include "net/base/descriptor_limit.h"

#include <catch2/catch.hpp>

#include <sys/resource.h>

namespace {

using namespace gs::net;

TEST_CASE("raises the limit of descriptors up to the hard limit, and never lowers it") {
  rlimit before{};
  REQUIRE(::getrlimit(RLIMIT_NOFILE, &before) == 0);
  rlimit low = before;
  low.rlim_cur = 200;
  REQUIRE(before.rlim_max >= 300);
  REQUIRE(::setrlimit(RLIMIT_NOFILE, &low) == 0);
  CHECK(raise_descriptor_limit(300) == 300);
  CHECK(raise_descriptor_limit(100) == 300);
  if (before.rlim_max != RLIM_INFINITY) {
    const auto most = static_cast<std::size_t>(before.rlim_max);
    CHECK(raise_descriptor_limit(most + 1) == most);
  }
  CHECK(::setrlimit(RLIMIT_NOFILE, &before) == 0);
}

}  // namespace
