#include "app/loading/fetch/small_request.h"

#include "net/base/url.h"
#include "net/load/loader.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace gs::app {

SmallAnswer small_request(net::Request request, bool head_only, const LoadOptions& load, const std::atomic<bool>& stop,
                          std::uint64_t most_bytes) {
  std::mutex mutex;
  std::condition_variable news;
  bool woken = false;
  net::LoaderOptions options;
  options.memory = load.memory;
  options.remote_program = load.remote_program;
  const net::Url parsed = net::parse_url(request.url);
  if (parsed.scheme == "ssh") options.policy.allow_ssh(parsed);
  options.wake = [&] {
    const std::lock_guard lock(mutex);
    woken = true;
    news.notify_one();
  };
  const auto loader = net::Loader::create(std::move(options));
  if (!head_only) request.max_bytes = most_bytes;
  request.cache = net::CacheUse::never_store;
  (void)loader->request(std::move(request));
  SmallAnswer answer;
  constexpr std::chrono::milliseconds kSlice{100};
  for (std::chrono::milliseconds waited{0}; waited < std::chrono::seconds(30) && !stop; waited += kSlice) {
    for (const net::LoadEvent& event : loader->poll()) {
      if (const auto* const head = std::get_if<net::LoadHead>(&event.what)) {
        answer.version =
            head->validator.etag + ' ' + head->validator.last_modified + ' ' + std::to_string(head->total.value_or(0));
        answer.body.clear();
        if (head_only) return answer;
      }
      if (const auto* const data = std::get_if<net::LoadData>(&event.what))
        answer.body.append(reinterpret_cast<const char*>(data->bytes.data()), data->bytes.size());
      if (const auto* const error = std::get_if<net::LoadError>(&event.what))
        return {{}, {}, error->message, error->http_status};
      if (std::holds_alternative<net::LoadDone>(event.what)) return answer;
    }
    std::unique_lock lock(mutex);
    (void)news.wait_for(lock, kSlice, [&] { return woken; });
    woken = false;
  }
  return {{}, {}, "no answer for 30 s", 0};
}

}  // namespace gs::app
