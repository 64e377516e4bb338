#pragma once

#include "app/session/opening/document_readers.h"
#include "app/streams/load_ledger.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

class Session;

/// History of a download rate in bits/s: one sample per quarter second, for the last half minute.
class RateHistory {
 public:
  static constexpr std::size_t kSamples = 120;
  static constexpr double kSeconds = 0.25;

  /// Records the total number of bytes received by `now`. Returns true if samples were added.
  bool note(std::uint64_t bytes, double now);
  /// Returns the rate of the last second.
  [[nodiscard]] double rate() const;
  /// Returns the recorded samples, oldest first.
  [[nodiscard]] std::vector<float> samples() const;

 private:
  std::array<float, kSamples> rates_{};
  std::size_t count_ = 0;  // total number of samples
  std::optional<std::uint64_t> bytes_;
  double at_ = 0;
};

/// Downloads of all worlds of a session, active ones first. Costs nothing unless `refresh` is called.
class StreamList {
 public:
  struct Row {
    LoadRow load;
    std::string world;  // path of its world
    std::shared_ptr<LoadLedger> ledger;
    std::shared_ptr<Document> document;  // null if its world is not open
    std::string detail;                  // for a QNV stream: received and displayed parts
    double rate = 0;                     // bits/s
    std::vector<float> rates;            // see RateHistory::samples
    [[nodiscard]] bool ended() const { return load.ended.has_value(); }
  };
  /// Updates all rows, at most four times a second. `now` is in seconds of any clock.
  void refresh(const DocumentReaders& readers, double now);
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::size_t arriving() const;
  /// Cancels a stream.
  static void cancel(const Row& row) { row.ledger->cancel(row.load.number); }
  /// Marks a stream to be loaded again.
  void retry(const Row& row) { retried_.push_back(row); }
  [[nodiscard]] bool has_retries() const { return !retried_.empty(); }
  /// Loads the marked streams again: through their nodes' urls, or with the whole worlds.
  void send_retries(Session& session);
  /// Discards measurements when the list is no longer displayed.
  void clear();

 private:
  using Key = std::pair<const LoadLedger*, std::uint64_t>;
  std::vector<Row> rows_;
  std::map<Key, RateHistory> histories_;
  std::optional<double> next_;
  std::vector<Row> retried_;
};

/// Formats a rate: "1.5 Mbit/s".
[[nodiscard]] std::string readable_rate(double bits_a_second);
/// Returns the fraction of lost datagrams, 0 to 1; nullopt if the stream does not use datagrams.
[[nodiscard]] std::optional<double> loss_of(const LoadRow& row);

}  // namespace gs::app
