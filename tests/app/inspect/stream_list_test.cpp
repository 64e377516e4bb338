#include "app/inspect/stream_list.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::stream_list_test {

TEST_CASE("measures a rate over the last second, and limits its history") {
  RateHistory history;
  CHECK(history.rate() == 0);
  CHECK_FALSE(history.note(1000, 10));
  CHECK_FALSE(history.note(5000, 10.1));  // too early for a sample
  CHECK(history.note(2000, 10.25));       // 1000 bytes in a quarter of a second
  CHECK(history.rate() == Approx(32'000));
  CHECK(history.note(2000, 10.5));
  CHECK(history.rate() == Approx(16'000));
  CHECK(history.samples().size() == 2);
  // After a gap of a second the history shows the average.
  CHECK(history.note(6000, 11.5));
  CHECK(history.samples().size() == 6);
  CHECK(history.rate() == Approx(32'000));
  // Another load starts from 0.
  CHECK(history.note(100, 11.75));
  CHECK(history.samples().back() == Approx(3200));
  for (int i = 0; i < 1000; ++i) (void)history.note(100, 12 + i * 0.25);
  CHECK(history.samples().size() == RateHistory::kSamples);
  CHECK(history.rate() == 0);
}

TEST_CASE("reports the progress of each load, and forgets the oldest finished one") {
  LoadLedger ledger;
  const std::uint64_t first = ledger.begin("http://host/a.qnv", "http", nullptr);
  const std::uint64_t second = ledger.begin("b.wrl", "file", nullptr);
  ledger.receive(first, 100, 400);
  ledger.show(first);
  ledger.receive(first, 300, {});
  ledger.count_cells(first, {9, 1, 5'000'000, 1'200'000, 0.01, false});
  ledger.end(second, LoadStage::failed, "there is no such file");
  ledger.end(second, LoadStage::whole);  // ended
  std::vector<LoadRow> rows = ledger.rows();
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].stage == LoadStage::arriving);
  CHECK(rows[0].received == 400);
  CHECK(rows[0].total == 400U);
  CHECK(rows[0].first_picture);
  CHECK_FALSE(rows[0].ended);
  CHECK(loss_of(rows[0]) == Approx(0.1));
  CHECK(state_of(rows[0]) == "arriving");
  CHECK(slowness_of(rows[0]) == "slowed by losses: 1.2 Mbit/s of 5.0 Mbit/s");
  CHECK(rows[1].stage == LoadStage::failed);
  CHECK(rows[1].why == "there is no such file");
  CHECK_FALSE(loss_of(rows[1]));
  CHECK(name_of(rows[1].stage) == "failed");
  for (std::size_t i = 0; i < LoadLedger::kMax; ++i) ledger.end(ledger.begin("x", "data", nullptr), LoadStage::whole);
  rows = ledger.rows();
  CHECK(rows.size() == LoadLedger::kMax);
  CHECK(rows.front().number == first);  // not ended
}

TEST_CASE("names the state of a download, with its losses and their effect on the rate") {
  LoadRow row;
  row.stage = LoadStage::whole;
  CHECK(state_of(row) == "complete");
  row.cells = {72, 28, 5'000'000, 1'000'000, 0.02, true};
  CHECK(state_of(row) == "complete, 28 % lost");
  row.cells.missing = false;  // repaired
  CHECK(state_of(row) == "complete");
  CHECK_FALSE(slowness_of(row).empty());
  row.cells.rate = 4'900'000;
  CHECK(slowness_of(row).empty());
  row.cells.rate = 1'000'000;
  row.cells.loss_events = 0;  // the user limits the rate
  CHECK(slowness_of(row).empty());
  row.cells.loss_events = 0.02;
  row.ended = 3;
  CHECK(slowness_of(row).empty());
}

TEST_CASE("limits the rate of a world, and wakes its reader") {
  LoadLedger ledger;
  int woken = 0;
  ledger.set_wake([&] { ++woken; });
  CHECK_FALSE(ledger.rate());
  ledger.set_rate(200'000);
  CHECK(ledger.rate() == 200'000U);
  ledger.set_rate(200'000);
  CHECK(woken == 1);
  ledger.set_rate(0);
  CHECK(ledger.rate() == 0U);
  CHECK(woken == 2);
  // The total also counts the received bytes of finished rows.
  ledger.receive(ledger.begin("a", "http", nullptr), 100, {});
  ledger.receive(ledger.begin("b", "http", nullptr), 20, {});
  CHECK(ledger.received() == 120);
  ledger.receive(ledger.begin("c", "file", nullptr), 5, {});  // an unknown number
  CHECK(ledger.received() == 120);
}

TEST_CASE("completes a stream of view-dependent chunks when all are received") {
  LoadLedger ledger;
  const std::uint64_t number = ledger.begin("a.qnv", "http", nullptr);
  ledger.receive(number, 64, 128);
  ledger.follow(number, nullptr, true);
  CHECK(ledger.rows()[0].stage == LoadStage::arriving);
  ledger.receive(number, 64, {});
  CHECK(ledger.rows()[0].stage == LoadStage::whole);
  CHECK(ledger.rows()[0].ended);
}

TEST_CASE("wakes the reader of a cancelled load unless the load has ended") {
  LoadLedger ledger;
  int woken = 0;
  ledger.set_wake([&] { ++woken; });
  const std::uint64_t number = ledger.begin("a.qnv", "http", nullptr);
  ledger.cancel(number);
  CHECK(woken == 1);
  CHECK(ledger.take_cancelled() == std::vector<std::uint64_t>{number});
  CHECK(ledger.take_cancelled().empty());
  ledger.end(number, LoadStage::cancelled);
  ledger.cancel(number);
  CHECK(woken == 1);
}

TEST_CASE("prints rates in network units") {
  CHECK(readable_rate(0) == "0 bit/s");
  CHECK(readable_rate(999) == "999 bit/s");
  CHECK(readable_rate(1500) == "1.5 kbit/s");
  CHECK(readable_rate(250'000) == "250 kbit/s");
  CHECK(readable_rate(12'300'000) == "12.3 Mbit/s");
}

}  // namespace gs::app::stream_list_test
