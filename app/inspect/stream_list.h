#pragma once

#include "app/session/session.h"
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

/// How fast something has come lately: bits a second, a number for each quarter of a second, of the last half minute.
class RateHistory {
 public:
  static constexpr std::size_t kSamples = 120;
  static constexpr double kSeconds = 0.25;

  /// So many bytes in all have come by `now`. True: it stands for another number of samples than before.
  bool note(std::uint64_t bytes, double now);
  /// The last second's.
  [[nodiscard]] double rate() const;
  /// The oldest first; as many as there are.
  [[nodiscard]] std::vector<float> samples() const;

 private:
  std::array<float, kSamples> rates_{};
  std::size_t count_ = 0;  // so far
  std::optional<std::uint64_t> bytes_;
  double at_ = 0;
};

/// The files and streams of all worlds of a session, as a list for who looks: those that still come before the others.
/// Costs nothing while nobody calls `refresh`.
class StreamList {
 public:
  struct Row {
    LoadRow load;
    std::string world;  // path
    std::shared_ptr<LoadLedger> ledger;
    std::shared_ptr<Document> document;  // null: its world is not open
    std::string detail;                  // of a stream of vectors: what of it is here and shown
    double rate = 0;                     // bits a second
    std::vector<float> rates;            // see RateHistory::samples
    [[nodiscard]] bool ended() const { return load.ended.has_value(); }
  };
  /// Takes in how far all are, four times a second at most. `now`: seconds of any clock.
  void refresh(const Session& session, double now);
  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::size_t arriving() const;
  /// Nobody looks any more: what was measured is forgotten.
  void clear();

 private:
  using Key = std::pair<const LoadLedger*, std::uint64_t>;
  std::vector<Row> rows_;
  std::map<Key, RateHistory> histories_;
  std::optional<double> next_;
};

/// "1.5 Mbit/s".
[[nodiscard]] std::string readable_rate(double bits_a_second);
/// Of the datagrams of a stream those that were lost, 0 to 1; nothing: it comes as something else.
[[nodiscard]] std::optional<double> loss_of(const LoadRow& row);

}  // namespace gs::app
