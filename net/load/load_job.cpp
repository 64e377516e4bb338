#include "net/load/load_job.h"

#include <algorithm>

namespace gs::net {
namespace {

/// Maximum cached bytes that one step delivers.
constexpr std::size_t kPumpBytes = std::size_t{1} << 20;
constexpr std::size_t kPumpedBlock = std::size_t{64} << 10;

}  // namespace

LoadJob::LoadJob(JobContext& context, RequestId id, Request request)
    : context_(context),
      id_(id),
      request_(std::move(request)),
      location_(context.options, request_),
      delivery_(context.queue, id, request_),
      cache_(context.cache, context.unix_seconds, request_, location_),
      plan_(context.cancel, context.options.join_gap) {}

LoadJob::~LoadJob() {
  plan_.stop_all();
  // Keep received bytes of a cancelled request in the cache.
  if (!over_) cache_.commit(std::nullopt);
}

void LoadJob::begin() {
  if (const auto why = location_.invalid()) return fail(LoadErrorKind::bad_request, *why);
  if (const auto error = location_.forbidden()) return fail(error->kind, error->message);
  open_version();
}

void LoadJob::fail(LoadErrorKind kind, const std::string& what, int http_status) {
  finish(LoadError{kind, location_.failure_text() + ": " + what, http_status});
}

void LoadJob::finish(std::variant<LoadDone, LoadError> how) {
  if (over_) return;
  plan_.stop_all();
  cache_.commit(std::holds_alternative<LoadDone>(how) ? version_.total : std::nullopt);
  cache_.close();
  over_ = true;
  context_.queue.push_end(id_, std::move(how));
}

void LoadJob::open_version() {
  plan_.finish_all();
  delivery_.begin();
  cache_.close();
  head_sent_ = false;
  version_ = {};
  const auto found = cache_.look_up(delivery_.needed(), delivery_.whole());
  if (!found) return plan_.add(delivery_.needed());
  version_ = found->version;
  if (cache_.trusted()) {
    emit_head(cache_.head().content_type);
    if (over_) return;
    plan_.add(found->missing);
    return check_done();
  }
  if (!found->all) return plan_.add(found->missing);
  const RangeSet wanted =
      version_.total ? delivery_.needed().within(ByteRange{0, *version_.total}) : delivery_.needed();
  plan_.add_conditional(delivery_.whole() || wanted.empty() ? ByteRange{} : wanted.ranges().front());
}

bool LoadJob::ready(const Fetch& fetch) const {
  if (fetch.finished || fetch.transfer || fetch.answer.held_end) return false;
  // The bytes before those of the fetch come from the cache or from another fetch.
  if (head_sent_ && !delivery_.is_next(fetch.position)) return false;
  // Until a response shows whether the server supports ranges, only the first unfinished fetch may start.
  return head_sent_ || context_.ranges_known.contains(location_.url()) || plan_.is_first_unfinished(fetch);
}

TransferRequest LoadJob::describe(const Fetch& fetch) const {
  TransferRequest result;
  result.url = location_.url();
  result.accept = request_.accept;
  result.post = request_.post;
  result.authorization = request_.authorization;
  result.reach = location_.reach();
  if (location_.scheme() && location_.scheme()->name == "ssh")
    result.within = context_.options.policy.ssh_folder(request_.from, parse_url(location_.url()));
  const bool all = fetch.position == 0 && fetch.range.end == kOpenEnd;
  if (!all) result.range = ByteRange{fetch.position, fetch.range.end};
  if (fetch.conditional && cache_.has_entry()) {
    result.if_none_match = version_.validator.etag;
    if (version_.validator.etag.empty()) result.if_modified_since = version_.validator.last_modified;
  } else if (!all) {
    result.if_range = head_sent_ || cache_.has_entry() ? version_.validator.strong() : request_.validator.strong();
  }
  return result;
}

void LoadJob::emit_head(const std::string& content_type) {
  head_sent_ = true;
  if (version_.total && !set_total(*version_.total)) return;
  context_.queue.push_head(id_, version_.head(location_.url(), content_type, cache_.has_entry()));
}

bool LoadJob::set_total(std::uint64_t total) {
  version_.total = total;
  const auto error = delivery_.limit_to(total);
  if (error) fail(error->kind, error->message);
  return !error;
}

bool LoadJob::void_version(LoadErrorKind kind, const std::string& why) {
  plan_.stop_all();
  if (delivery_.received() > 0 || head_sent_) ++restarts_;
  if (restarts_ > context_.options.max_restarts) {
    fail(kind, why + "; no version was received completely (tried " + std::to_string(restarts_) + " times)");
    return false;
  }
  cache_.close();
  cache_.drop();
  context_.ranges_known.erase(location_.url());
  context_.queue.restart(id_);
  cache_.set_searching(false);
  return true;
}

void LoadJob::restart(LoadErrorKind kind, const std::string& why, TimePoint not_before) {
  if (!void_version(kind, why)) return;
  const unsigned attempts = plan_.attempts();
  open_version();
  plan_.delay(not_before, attempts);
}

bool LoadJob::pump_cached(TimePoint now) {
  std::size_t budget = kPumpBytes;
  while (!over_ && cache_.trusted()) {
    const RangeSet pending = cache_.pending(delivery_.needed());
    if (pending.empty()) {
      check_done();
      break;
    }
    const std::size_t room = std::min({delivery_.room(), budget, kPumpedBlock});
    if (room == 0) return false;
    const ByteRange range = pending.ranges().front();
    const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(room, range.size()));
    const auto bytes = cache_.read(range.begin, most);
    if (!bytes) {
      restart(LoadErrorKind::changed, "its cache entry is damaged", now);
      return false;
    }
    budget -= bytes->size();
    delivery_.push(range.begin, *bytes);
  }
  return true;
}

bool LoadJob::pump(TimePoint now) {
  if (pump_cached(now)) {
    // Use indexes, because deliver() and on_end() may change or end the job.
    for (std::size_t i = 0; i < plan_.all().size() && !over_; ++i) {
      Fetch& fetch = *plan_.all()[i];
      if (fetch.finished || (fetch.answer.held.empty() && !fetch.answer.held_end)) continue;
      if (!delivery_.is_next(fetch.position)) continue;
      const auto held = std::exchange(fetch.answer.held, {});
      const auto end = std::exchange(fetch.answer.held_end, {});
      if (!held.empty() && deliver(fetch, held) == DataVerdict::stop) continue;
      if (end && !over_) on_end(fetch, *end, now);
    }
    // No transfer uses the finished fetches now.
    plan_.erase_finished();
  }
  return !over_ && cache_.trusted() && !cache_.pending(delivery_.needed()).empty();
}

void LoadJob::check_done() {
  if (!over_ && head_sent_ && delivery_.needed().empty()) finish(LoadDone{});
}

}  // namespace gs::net
