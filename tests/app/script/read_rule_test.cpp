#include "app/script/read_rule.h"

#include <catch2/catch.hpp>

#include <string>

// docs/security.md, "What Scripts may read", names these tests.
namespace gs::app::read_rule_test {
namespace {

using net::AddressSpace;
using net::Origin;
using script::Reading;
using script::reading;

const Origin kWorld{"file:///w/world.wrl"}, kOtherFile{"file:///w/other.wrl"};
const Origin kHost{"http://a/x.wrl", AddressSpace::global}, kSameHost{"http://a/y/z.wrl", AddressSpace::global};
const Origin kOtherHost{"http://b/x.wrl", AddressSpace::global};
const Origin kIntranet{"http://printer/x.wrl", AddressSpace::local};

}  // namespace

TEST_CASE("limits a Script from the network to nodes of its own host") {
  CHECK(reading(kHost, kHost, kHost) == Reading::allowed);
  CHECK(reading(kHost, kHost, kSameHost) == Reading::allowed);
  CHECK(reading(kHost, kHost, kOtherHost) == Reading::refused);
  CHECK(reading(kHost, kHost, kIntranet) == Reading::refused);
  CHECK(reading(kHost, kHost, {"https://a/x.wrl", AddressSpace::global}) == Reading::refused);
  CHECK(reading(kHost, kHost, {"http://a/x.wrl", AddressSpace::local}) == Reading::refused);
}

TEST_CASE("hides local files from a Script from the network, except the file that uses its PROTO") {
  CHECK(reading(kHost, kHost, kWorld) == Reading::refused);
  CHECK(reading(kHost, kWorld, kOtherFile) == Reading::refused);
  CHECK(reading(kHost, kWorld, kWorld) == Reading::confidential);
  CHECK(reading(kHost, kOtherHost, kOtherHost) == Reading::allowed);
}

TEST_CASE("lets a local Script read its own file freely, and other local files and networks confidentially") {
  CHECK(reading(kWorld, kWorld, kWorld) == Reading::allowed);
  CHECK(reading(kOtherFile, kWorld, kWorld) == Reading::allowed);
  CHECK(reading(kWorld, kWorld, kOtherFile) == Reading::confidential);
  CHECK(reading(kWorld, kWorld, kHost) == Reading::allowed);
  CHECK(reading(kWorld, kWorld, kIntranet) == Reading::confidential);
}

TEST_CASE("treats a text of unknown origin like one from the Internet") {
  const Origin unknown{"data:", AddressSpace::global};
  CHECK(reading(unknown, unknown, unknown) == Reading::allowed);
  CHECK(reading(unknown, unknown, kWorld) == Reading::refused);
  CHECK(reading(unknown, unknown, kHost) == Reading::refused);
}

TEST_CASE("shares a library between Scripts of one site or one local file") {
  CHECK(script::library_key(kHost) == script::library_key(kSameHost));
  CHECK(script::library_key(kHost) != script::library_key(kOtherHost));
  CHECK(script::library_key(kWorld) != script::library_key(kOtherFile));
}

}  // namespace gs::app::read_rule_test
