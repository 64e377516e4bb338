#pragma once

#include "app/loading/fetch/load_options.h"
#include "app/loading/fetch/small_request.h"
#include "app/session/viewports/session_viewports.h"
#include "app/session/viewports/step.h"
#include "base/noncopyable.h"

#include <atomic>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Parameter of a running simulation.
struct LiveParameter {
  std::string name, label, unit;
  double minimum = 0, maximum = 1, value = 0;
  bool integer = false;
};
/// Simulation that a world shows, as its JSON resource describes it (docs/insitu.md).
struct LiveState {
  std::vector<LiveParameter> parameters;
  std::vector<std::string> fields;
  std::string field;    // that is shown
  std::string message;  // why the last change was refused; empty if it was not
  std::string url;      // of the JSON resource
};

/// Parses the JSON resource of a simulation. Returns nullopt for other texts. Safe for untrusted texts.
[[nodiscard]] std::optional<LiveState> read_live_state(std::string_view json);

/// Returns the query that gives a parameter a value.
[[nodiscard]] std::string parameter_query(std::string_view name, double value);

/// Steering of the simulation that the active viewport shows. Polls its JSON resource once per second on other threads,
/// and sends changes. One thread; none in simulated time.
class LiveControl : NonCopyable {
 public:
  static constexpr double kWait = 1;

  /// Other threads call `wake`, which must be thread-safe.
  LiveControl(StepContext& step, SessionViewports& viewports, const LoadOptions& load, std::function<void()> wake)
      : step_(step), viewports_(viewports), load_(load), wake_(std::move(wake)) {}
  ~LiveControl() { stop_ = true; }

  /// Starts due requests, and takes their results.
  void check();
  /// Returns the time of the next request; nullopt if no simulation is visible.
  [[nodiscard]] std::optional<double> next_due() const;
  /// Returns the simulation of the active viewport; null if there is none.
  [[nodiscard]] const LiveState* state() const { return state_ ? &*state_ : nullptr; }
  /// Requests a change, such as "feed=0.03" or "field=V". If `token` is empty, uses token_of_simulation().
  void change(const std::string& query, const std::string& token);

 private:
  [[nodiscard]] std::string active_url() const;

  StepContext& step_;
  SessionViewports& viewports_;
  const LoadOptions& load_;
  std::function<void()> wake_;
  std::atomic<bool> stop_{false};
  std::string url_;
  std::optional<LiveState> state_;
  double due_ = 0;
  std::vector<std::pair<std::string, std::string>> changes_;  // queries and tokens, oldest first
  std::string message_;
  bool changing_ = false;  // `coming_` is a change
  bool stale_ = false;     // `coming_` is of another simulation than `url_`
  std::future<SmallAnswer> coming_;
};

/// Returns the token for a simulation on this machine, from its file (net::usual_token_file). Returns "" for other
/// hosts, or if the file is missing or invalid.
[[nodiscard]] std::string token_of_simulation(const std::string& url);

}  // namespace gs::app
