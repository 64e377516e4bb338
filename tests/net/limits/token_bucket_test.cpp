#include "net/limits/token_bucket.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::net;

TEST_CASE("passes a burst at once and then the rate", "[token_bucket]") {
  TokenBucket bucket(1'000'000, 3000, Instant(5));
  std::uint64_t passed = 0;
  Instant now(5);
  const Instant end = now + Instant(10'000'000);
  for (;;) {
    now = bucket.when(1000, now);
    if (now > end) break;
    REQUIRE(bucket.has(1000, now));
    bucket.take(1000, now);
    passed += 1000;
  }
  REQUIRE(passed == 10'003'000);
}

TEST_CASE("saves at most its burst", "[token_bucket]") {
  TokenBucket bucket(1000, 2000, Instant(0));
  bucket.take(2000, Instant(0));
  REQUIRE_FALSE(bucket.has(1, Instant(0)));
  REQUIRE(bucket.when(1, Instant(0)) == Instant(1000));
  REQUIRE(bucket.has(2000, Instant(1'000'000'000)));
  bucket.take(2000, Instant(1'000'000'000));
  REQUIRE_FALSE(bucket.has(1, Instant(1'000'000'000)));
  // An amount above the burst waits only for a full bucket.
  REQUIRE(bucket.when(5000, Instant(1'000'000'000)) == Instant(1'002'000'000));
}

TEST_CASE("waits for a new rate if the rate is 0", "[token_bucket]") {
  TokenBucket bucket(0, 1000, Instant(0));
  bucket.take(1000, Instant(0));
  REQUIRE(bucket.when(1, Instant(10)) == Instant::max());
  bucket.set_rate(1'000'000, 1000, Instant(20));
  REQUIRE(bucket.when(10, Instant(20)) == Instant(30));
  bucket.set_rate(~std::uint64_t{0}, ~std::uint64_t{0}, Instant(20));
  REQUIRE(bucket.has(1'000'000, Instant(90'000'000)));
  // A time in the past changes nothing.
  REQUIRE(bucket.has(1'000'000, Instant(5)));
}

TEST_CASE("lets an allowed debt pass early, and waits until it is paid back", "[token_bucket]") {
  TokenBucket bucket(1'000'000, 2000, Instant(0));
  bucket.allow_debt(10'000);
  for (int i = 0; i < 6; ++i) {
    REQUIRE(bucket.has(2000, Instant(0)));
    bucket.take(2000, Instant(0));
  }
  REQUIRE_FALSE(bucket.has(1, Instant(0)));
  REQUIRE(bucket.when(1000, Instant(0)) == Instant(1000));
  bucket.allow_debt(0);
  REQUIRE(bucket.when(1000, Instant(0)) == Instant(11'000));
  // In one second, at most the rate and the burst pass.
  REQUIRE(bucket.has(2000, Instant(12'000)));
  // Without a rate, a debt can never be paid back.
  TokenBucket none(0, 1000, Instant(0));
  none.allow_debt(5000);
  none.take(1000, Instant(0));
  REQUIRE_FALSE(none.has(1, Instant(0)));
}

}  // namespace
