#pragma once

#include "app/base/load_limit.h"
#include "app/loading/fetch/fetcher.h"
#include "app/loading/fetch/load_options.h"
#include "app/loading/fetch/waker.h"
#include "app/loading/updates/load_results.h"
#include "app/streams/load_ledger.h"
#include "base/budget.h"

#include <chrono>
#include <memory>
#include <string>

namespace gs::app {

/// Parts that all handlers of one world share. Used by the reader thread.
struct Loading {
  Loading(const std::string& path, const LoadOptions& given);
  ~Loading();
  Loading(const Loading&) = delete;
  Loading& operator=(const Loading&) = delete;

  LoadOptions options;
  std::shared_ptr<LoadLedger> ledger;
  LoadLimit limit;
  WorldBudget budget;
  std::shared_ptr<Waker> waker = std::make_shared<Waker>();
  std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  LoadResults results;
  std::shared_ptr<const ListedFolder> listed;  // folder of a scan on a server; null for other worlds
  Fetcher fetcher;
};

/// Returns the time limit of `options`, from now on.
[[nodiscard]] LoadLimit limit_of(const LoadOptions& options);

}  // namespace gs::app
