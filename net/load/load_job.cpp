#include "net/load/load_job.h"

#include <algorithm>
#include <array>

namespace gs::net {
namespace {

/// Maximum cached bytes that one step delivers.
constexpr std::size_t kPumpBytes = std::size_t{1} << 20;
constexpr std::size_t kPumpedBlock = std::size_t{64} << 10;

bool has_control_or_blank(std::string_view text, bool blank_too) {
  return std::any_of(text.begin(), text.end(), [blank_too](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f || (blank_too && byte == 0x20);
  });
}

}  // namespace

LoadJob::LoadJob(JobContext& context, RequestId id, Request request)
    : context_(context),
      id_(id),
      request_(std::move(request)),
      first_url_(request_.url),
      reach_(request_.from.reach()) {
  set_url(request_.url);
}

LoadJob::~LoadJob() {
  stop_all();
  // Keep received bytes of a cancelled request in the cache.
  if (writer_ && !over_) writer_->commit(std::nullopt, context_.unix_seconds());
}

void LoadJob::set_url(std::string url) {
  const std::string name = parse_url(std::string_view(url).substr(0, 32)).scheme;
  scheme_ = find_scheme(name);
  host_.clear();
  // Write the scheme in lower case.
  if (scheme_) url.replace(0, name.size(), name);
  // The fragment is removed from all URLs except data: URLs, where it is part of the data.
  if (!scheme_ || scheme_->transport != TransportKind::data) url.resize(std::min(url.find('#'), url.size()));
  url_ = std::move(url);
  if (!scheme_ || !scheme_->has_host) return;
  // Use the canonical URL for cache, policy, transport and document. Leave a URL without a host unchanged; the policy
  // refuses it.
  if (const auto canonical = canonical_url(parse_url(url_))) {
    url_ = canonical->text();
    host_ = canonical->scheme + "://" + canonical->authority;
  }
}

std::string LoadJob::key() const { return url_ + "\n" + request_.accept; }

bool LoadJob::may_cache() const {
  return context_.cache && scheme_ && scheme_->cached && request_.cache != CacheUse::never_store &&
         parse_url(url_).authority.find('@') == std::string::npos;
}

std::optional<std::string> LoadJob::refusal() const {
  constexpr std::size_t kLongestUrl = 16384;
  const bool data = scheme_ && scheme_->transport == TransportKind::data;
  if (url_.empty()) return "it is empty; expected an absolute URL";
  if (!data && url_.size() > kLongestUrl) return "it is longer than " + std::to_string(kLongestUrl) + " bytes";
  if (!data && has_control_or_blank(url_, true))
    return "it contains a blank or a control character; expected percent-encoding";
  if (has_control_or_blank(request_.accept, false)) return "the accepted media types contain a control character";
  if (request_.ranges.size() > context_.options.max_ranges)
    return std::to_string(request_.ranges.size()) + " ranges were requested; expected at most " +
           std::to_string(context_.options.max_ranges);
  for (const ByteRange& range : request_.ranges)
    if (range.empty())
      return "an empty range was requested (" + std::to_string(range.begin) + " to " + std::to_string(range.end) + ")";
  return std::nullopt;
}

void LoadJob::begin() {
  if (const auto why = refusal()) return fail(LoadErrorKind::bad_request, *why);
  const bool data = scheme_ && scheme_->transport == TransportKind::data;
  if (const auto why = context_.options.policy.refuse(request_.from, parse_url(data ? "data:" : url_)))
    return fail(scheme_ ? LoadErrorKind::forbidden : LoadErrorKind::unsupported, why->message);
  open_version();
}

void LoadJob::fail(LoadErrorKind kind, const std::string& what, int http_status) {
  std::string message = "cannot load " + url_for_messages(url_);
  if (redirects_ > 0) message += " (redirected from " + url_for_messages(first_url_) + ")";
  finish(LoadError{kind, message + ": " + what, http_status});
}

void LoadJob::finish(std::variant<LoadDone, LoadError> how) {
  if (over_) return;
  stop_all();
  if (writer_) writer_->commit(std::holds_alternative<LoadDone>(how) ? total_ : std::nullopt, context_.unix_seconds());
  writer_.reset();
  cached_.reset();
  over_ = true;
  context_.queue.push_end(id_, std::move(how));
}

void LoadJob::stop(Fetch& fetch) {
  if (fetch.transfer) context_.cancel(fetch.transfer);
  fetch.transfer = 0;
}

void LoadJob::stop_all() {
  for (const auto& fetch : fetches_) stop(*fetch);
}

void LoadJob::open_version() {
  // Callers may still use these fetches, so mark them as finished. A later step deletes them.
  stop_all();
  for (const auto& fetch : fetches_) fetch->finished = true;
  needed_ = whole() ? RangeSet(std::array{ByteRange{}}) : RangeSet(request_.ranges);
  received_ = 0;
  head_sent_ = trusted_ = encoded_ = accepts_ranges_ = false;
  version_ = {};
  total_.reset();
  cached_.reset();
  writer_.reset();
  if (use_cache_ && may_cache() && request_.cache == CacheUse::normal)
    look_up();
  else
    plan(needed_);
}

void LoadJob::look_up() {
  const std::int64_t now = context_.unix_seconds();
  auto found = context_.cache->find(key(), now);
  if (!found || (!request_.validator.empty() && !request_.validator.agrees(found->head().validator)) ||
      !reaches(reach_, found->head().space))
    return plan(needed_);
  const CachedHead& head = found->head();
  const bool continuable = !head.encoded && !head.validator.strong().empty();
  RangeSet wanted = head.total ? needed_.within(ByteRange{0, *head.total}) : needed_;
  const bool all = wanted.without(found->present()).empty() && (head.total || !whole());
  cached_part_ = {};
  if (whole() && !all) {
    // The whole resource is delivered in order, so use only the cached bytes at its start.
    const RangeSet front = found->present().within(ByteRange{});
    cached_part_ = front.empty() || front.ranges().front().begin > 0 ? ByteRange{0, 0} : front.ranges().front();
  }
  const RangeSet missing = wanted.without(found->present().within(cached_part_));
  const bool fresh = found->fresh(now);
  const bool useless = !all && (!continuable || missing == wanted);
  // A stale version without a validator is useless, because the server cannot confirm it.
  const bool unconfirmable = !fresh && head.validator.empty();
  if (useless || unconfirmable) return plan(needed_);
  version_ = head.validator;
  total_ = head.total;
  encoded_ = head.encoded;
  accepts_ranges_ = head.accepts_ranges;
  space_ = head.space;
  cached_ = std::move(found);
  if (fresh) {
    trusted_ = true;
    emit_head({url_, total_, cached_->head().content_type, version_, accepts_ranges_, true, space_});
    if (over_) return;
    plan(missing);
    return check_done();
  }
  if (!all) return plan(missing);
  plan(RangeSet(std::array{whole() || wanted.empty() ? ByteRange{} : wanted.ranges().front()}));
  fetches_.back()->conditional = true;
}

void LoadJob::plan(const RangeSet& missing) {
  for (const ByteRange& range : missing.joined(context_.options.join_gap)) {
    auto fetch = std::make_unique<Fetch>();
    fetch->range = range;
    fetch->position = range.begin;
    fetches_.push_back(std::move(fetch));
  }
}

void LoadJob::plan_what_is_missing() {
  RangeSet planned;
  for (const auto& fetch : fetches_)
    if (!fetch->finished) planned.add({fetch->position, fetch->range.end});
  RangeSet missing = needed_.without(planned);
  if (cached_) missing = missing.without(cached_pending());
  plan(missing);
}

RangeSet LoadJob::cached_pending() const {
  return cached_ ? needed_.within(cached_->present().within(cached_part_)) : RangeSet();
}

bool LoadJob::ready(const Fetch& fetch) const {
  if (fetch.finished || fetch.transfer || fetch.answer.held_end) return false;
  if (whole() && trusted_ && !cached_pending().empty()) return false;
  if (head_sent_ || context_.ranges_known.contains(url_)) return true;
  // Until a response shows whether the server supports ranges, only the first unfinished fetch may start.
  for (const auto& other : fetches_)
    if (!other->finished) return other.get() == &fetch;
  return false;
}

TransferRequest LoadJob::describe(const Fetch& fetch) const {
  TransferRequest result;
  result.url = url_;
  result.accept = request_.accept;
  result.reach = reach_;
  const bool all = fetch.position == 0 && fetch.range.end == kOpenEnd;
  if (!all) result.range = ByteRange{fetch.position, fetch.range.end};
  if (fetch.conditional && cached_) {
    result.if_none_match = version_.etag;
    if (version_.etag.empty()) result.if_modified_since = version_.last_modified;
  } else if (!all) {
    result.if_range = head_sent_ || cached_ ? version_.strong() : request_.validator.strong();
  }
  return result;
}

void LoadJob::emit_head(LoadHead head) {
  head_sent_ = true;
  if (!clamp()) return;
  context_.queue.push_head(id_, std::move(head));
}

bool LoadJob::clamp() {
  const std::uint64_t most = request_.max_bytes;
  if (total_) {
    for (const ByteRange& range : request_.ranges)
      if (range.begin > 0 && range.begin >= *total_) {
        fail(LoadErrorKind::bad_request,
             "byte " + std::to_string(range.begin) + " was requested; it has " + std::to_string(*total_) + " bytes");
        return false;
      }
    needed_ = needed_.within(ByteRange{0, *total_});
    if (needed_.size() + received_ > most) {
      fail(LoadErrorKind::too_large,
           "it has " + std::to_string(needed_.size() + received_) + " bytes; expected at most " + std::to_string(most));
      return false;
    }
  }
  return true;
}

bool LoadJob::void_version(LoadErrorKind kind, const std::string& why) {
  stop_all();
  if (received_ > 0 || head_sent_) ++restarts_;
  if (restarts_ > context_.options.max_restarts) {
    fail(kind, why + "; no version was received completely (tried " + std::to_string(restarts_) + " times)");
    return false;
  }
  writer_.reset();
  if (may_cache()) context_.cache->drop(key());
  context_.ranges_known.erase(url_);
  context_.queue.restart(id_);
  use_cache_ = false;
  return true;
}

void LoadJob::restart(LoadErrorKind kind, const std::string& why, TimePoint not_before) {
  if (!void_version(kind, why)) return;
  unsigned attempts = 0;
  for (const auto& fetch : fetches_) attempts = std::max(attempts, fetch->attempts);
  open_version();
  for (const auto& fetch : fetches_)
    if (!fetch->finished) {
      fetch->not_before = not_before;
      fetch->attempts = attempts;
    }
}

bool LoadJob::pump(TimePoint now) {
  std::size_t budget = kPumpBytes;
  while (!over_ && trusted_ && cached_) {
    const RangeSet pending = cached_pending();
    if (pending.empty()) {
      check_done();
      break;
    }
    const std::size_t room = std::min({context_.queue.room(id_), budget, kPumpedBlock});
    if (room == 0) return budget == 0;
    const ByteRange range = pending.ranges().front();
    const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(room, range.size()));
    const auto bytes = cached_->read(range.begin, most);
    if (!bytes) {
      restart(LoadErrorKind::changed, "its cache entry is damaged", now);
      return true;
    }
    budget -= bytes->size();
    received_ += bytes->size();
    needed_.subtract({range.begin, range.begin + bytes->size()});
    context_.queue.push_data(id_, range.begin, *bytes);
  }
  // Use indexes, because deliver() and on_end() may change or end the job.
  for (std::size_t i = 0; i < fetches_.size() && !over_; ++i) {
    Fetch& fetch = *fetches_[i];
    if (fetch.finished || (fetch.answer.held.empty() && !fetch.answer.held_end)) continue;
    const auto held = std::exchange(fetch.answer.held, {});
    const auto end = std::exchange(fetch.answer.held_end, {});
    if (!held.empty() && deliver(fetch, held) == DataVerdict::stop) continue;
    if (end && !over_) on_end(fetch, *end, now);
  }
  // No transfer uses the finished fetches now.
  std::erase_if(fetches_, [](const auto& fetch) { return fetch->finished && !fetch->transfer; });
  return false;
}

void LoadJob::check_done() {
  if (!over_ && head_sent_ && needed_.empty()) finish(LoadDone{});
}

}  // namespace gs::net
