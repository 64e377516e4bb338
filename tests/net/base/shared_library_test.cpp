#include "net/base/shared_library.h"

#include <catch2/catch.hpp>

#include <cstring>

using gs::net::SharedLibrary;

TEST_CASE("opens a library on first use, and reports missing symbols") {
  std::size_t (*length)(const char*) = nullptr;
  SharedLibrary here("libc.so.6");
  here.find("strlen", length);
  REQUIRE(length);
  CHECK(length("four") == 4);
  CHECK(here.problem().empty());
  int (*none)() = nullptr;
  here.find("there_is_no_such_function", none);
  CHECK_FALSE(none);
  CHECK(here.problem() == "libc.so.6 has no there_is_no_such_function");

  SharedLibrary missing("libghostspace_missing.so.1");
  missing.find("strlen", none);
  CHECK_FALSE(none);
  CHECK(missing.problem() == "libghostspace_missing.so.1 cannot be opened; install it");
}
