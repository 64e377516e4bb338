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

/// Download rate over the last half minute, in bits per second. Has one sample per quarter second.
class RateHistory {
 public:
  static constexpr std::size_t kSamples = 120;
  static constexpr double kSeconds = 0.25;

  /// Adds samples. `bytes` is the total number of bytes received by time `now` (seconds). Returns true if a sample was
  /// due.
  bool note(std::uint64_t bytes, double now);
  /// Returns the average rate of the last second, in bits per second.
  [[nodiscard]] double rate() const;
  /// Returns the samples so far, oldest first.
  [[nodiscard]] std::vector<float> samples() const;

 private:
  std::array<float, kSamples> rates_{};
  std::size_t count_ = 0;  // number of samples ever added
  std::optional<std::uint64_t> bytes_;
  double at_ = 0;
};

/// Downloads of all worlds of a session, those in progress first. Costs nothing while `refresh` is not called.
class StreamList {
 public:
  struct Row {
    LoadRow load;
    std::string world;  // path or URL of the world with the download
    std::shared_ptr<LoadLedger> ledger;
    std::shared_ptr<Document> document;  // null if that world is not open
    std::string detail;                  // for a QNV stream: text about received and visible parts
    double rate = 0;                     // current rate in bits per second
    std::vector<float> rates;            // as from RateHistory::samples
    [[nodiscard]] bool ended() const { return load.ended.has_value(); }
  };
  /// Updates all rows, at most four times per second. `now` is in seconds of any clock.
  void refresh(const DocumentReaders& readers, double now);
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::size_t arriving() const;
  /// Cancels the download of a row.
  static void cancel(const Row& row) { row.ledger->cancel(row.load.number); }
  /// Notes that a row must be loaded again.
  void retry(const Row& row) { retried_.push_back(row); }
  [[nodiscard]] bool has_retries() const { return !retried_.empty(); }
  /// Loads the rows of retry() again: through the url of the node, or by opening the whole world.
  void send_retries(Session& session);
  /// Drops all samples. Call when the list is no longer displayed.
  void clear();

 private:
  using Key = std::pair<const LoadLedger*, std::uint64_t>;
  std::vector<Row> rows_;
  std::map<Key, RateHistory> histories_;
  std::optional<double> next_;
  std::vector<Row> retried_;
};

/// Formats a rate in bits per second: "1.5 Mbit/s".
[[nodiscard]] std::string readable_rate(double bits_a_second);
/// Returns the fraction of datagrams that were lost, 0 to 1. Returns nullopt if the download uses no datagrams.
[[nodiscard]] std::optional<double> loss_of(const LoadRow& row);
/// Returns the stage of a download in words. Includes the fraction of lost datagrams if data are missing at the end.
[[nodiscard]] std::string state_of(const LoadRow& row);
/// Returns text if the server of a download sends more slowly because of losses; otherwise an empty string.
[[nodiscard]] std::string slowness_of(const LoadRow& row);

}  // namespace gs::app
