#include "net/load/load_engine.h"

#include <algorithm>
#include <deque>

namespace gs::net {
namespace {

/// Maximum number of preempted transfers. They do not count as concurrent transfers.
constexpr std::size_t kMaxPreempted = 4;
constexpr std::size_t kMaxPreemptedPerHost = 2;

template <class Key>
std::size_t count_of(const std::map<Key, std::size_t>& counts, const Key& key) {
  const auto found = counts.find(key);
  return found == counts.end() ? 0 : found->second;
}

}  // namespace

LoadEngine::LoadEngine(const LoaderOptions& options, LoadQueue& queue, HttpCache* cache)
    : options_(options),
      queue_(queue),
      context_{options, queue, cache, options.random, options.unix_seconds, [this](TransferId id) { stop(id); },
               {},      {}} {}

LoadEngine::~LoadEngine() { jobs_.clear(); }

void LoadEngine::add_transport(TransportKind kind, std::unique_ptr<Transport> transport) {
  transports_[kind] = std::move(transport);
}

void LoadEngine::refuse_transport(TransportKind kind, std::string why) { refused_transports_[kind] = std::move(why); }

void LoadEngine::request(RequestId id, Request request) {
  auto& job = jobs_[id];
  job = std::make_unique<LoadJob>(context_, id, std::move(request));
  job->begin();
  touched_.insert(id);
}

void LoadEngine::cancel(RequestId id) {
  if (jobs_.erase(id) > 0) schedule_needed_ = true;
  touched_.erase(id);
  pumping_.erase(id);
}

void LoadEngine::set_priority(RequestId id, int priority) {
  const auto found = jobs_.find(id);
  if (found == jobs_.end()) return;
  found->second->set_priority(priority);
  schedule_needed_ = true;
}

HeadVerdict LoadEngine::on_head(TransferId id, const ResponseHead& head) {
  const auto found = running_.find(id);
  if (found == running_.end()) return HeadVerdict::stop;
  const Running running = found->second;
  touched_.insert(running.job->id());
  const HeadVerdict verdict = running.job->on_head(*running.fetch, head);
  if (verdict == HeadVerdict::stop) stop(id);
  return verdict;
}

DataVerdict LoadEngine::on_data(TransferId id, std::span<const std::byte> bytes) {
  const auto found = running_.find(id);
  if (found == running_.end()) return DataVerdict::stop;
  const Running running = found->second;
  const DataVerdict verdict = running.job->on_data(*running.fetch, bytes);
  if (verdict == DataVerdict::pause) running.fetch->paused = true;
  if (verdict != DataVerdict::more) touched_.insert(running.job->id());
  if (verdict == DataVerdict::stop) stop(id);
  return verdict;
}

std::optional<LoadEngine::Running> LoadEngine::remove(TransferId id) {
  const auto found = running_.find(id);
  if (found == running_.end()) return std::nullopt;
  const Running running = found->second;
  running_.erase(found);
  running.fetch->transfer = 0;
  running.fetch->paused = running.fetch->preempted = false;
  return running;
}

void LoadEngine::on_end(TransferId id, const TransferEnd& end) {
  const auto running = remove(id);
  if (!running) return;
  touched_.insert(running->job->id());
  running->job->on_end(*running->fetch, end, now_);
}

void LoadEngine::stop(TransferId id) {
  const auto running = remove(id);
  if (!running) return;
  running->transport->cancel(id);
  schedule_needed_ = true;
}

std::optional<TimePoint> LoadEngine::step(TimePoint now) {
  now_ = now;
  for (auto& [kind, transport] : transports_) transport->step(*this, now);
  pump();
  hold_back();
  if (schedule_needed_ || (next_ready_ && *next_ready_ <= now)) schedule();
  return next_deadline();
}

void LoadEngine::pump() {
  std::set<RequestId> now_pumped = std::exchange(touched_, {});
  if (!now_pumped.empty()) schedule_needed_ = true;
  now_pumped.insert(pumping_.begin(), pumping_.end());
  for (const RequestId id : now_pumped) {
    const auto found = jobs_.find(id);
    if (found == jobs_.end()) continue;
    LoadJob& job = *found->second;
    const bool more = job.pump(now_);
    if (!more && pumping_.erase(id) > 0) schedule_needed_ = true;
    if (more) pumping_.insert(id);
    if (job.over()) jobs_.erase(found);
  }
}

void LoadEngine::hold_back() {
  for (const auto& [id, running] : running_) {
    const bool wait = running.fetch->preempted || running.job->must_wait(*running.fetch);
    if (wait == running.fetch->paused) continue;
    running.fetch->paused = wait;
    running.transport->pause(id, wait);
  }
}

LoadEngine::Load LoadEngine::count_load() const {
  Load load;
  for (const auto& [id, running] : running_) {
    const std::string& host = running.job->location().host();
    ++(running.fetch->preempted ? load.all_preempted : load.all);
    if (!host.empty()) ++(running.fetch->preempted ? load.host_preempted : load.host)[host];
    if (!running.fetch->preempted) ++load.viewport[running.job->request().viewport];
  }
  return load;
}

bool LoadEngine::fits(const LoadJob& job, const Load& load) const {
  return load.all < options_.max_transfers &&
         (job.location().host().empty() ||
          count_of(load.host, job.location().host()) < options_.max_transfers_per_host);
}

/// Preempts a transfer of lower priority to make room for a transfer of `job`. Returns true if it now fits.
bool LoadEngine::make_room(const LoadJob& job, Load& load) {
  const std::string& host = job.location().host();
  const bool host_full = !host.empty() && count_of(load.host, host) >= options_.max_transfers_per_host;
  if (load.all_preempted >= kMaxPreempted) return false;
  Running* least = nullptr;
  TransferId least_id = 0;
  for (auto& [id, running] : running_) {
    if (running.fetch->preempted || running.job->request().priority >= job.request().priority) continue;
    if (host_full && running.job->location().host() != host) continue;
    if (count_of(load.host_preempted, running.job->location().host()) >= kMaxPreemptedPerHost) continue;
    // Among transfers of the lowest priority, preempt the newest, because it probably has most bytes left.
    if (least &&
        std::pair(-least->job->request().priority, least_id) >= std::pair(-running.job->request().priority, id))
      continue;
    least = &running;
    least_id = id;
  }
  if (!least) return false;
  least->fetch->preempted = true;
  least->fetch->paused = true;
  least->transport->pause(least_id, true);
  load = count_load();
  return fits(job, load);
}

void LoadEngine::let_run(const Candidate& candidate, Load& load) {
  const auto& [job, fetch] = candidate;
  if (fetch->preempted) {
    fetch->preempted = false;  // hold_back() in the next step resumes the transfer
    load = count_load();
    next_ready_ = now_;
    return;
  }
  const auto transport = transports_.find(job->location().scheme()->transport);
  if (transport == transports_.end()) {
    const auto refused = refused_transports_.find(job->location().scheme()->transport);
    job->fail(LoadErrorKind::unsupported,
              "no transport for the scheme " + std::string(job->location().scheme()->name) + ":" +
                  (refused == refused_transports_.end() ? "" : " (" + refused->second + ")"));
    touched_.insert(job->id());
    return;
  }
  fetch->transfer = ++last_transfer_;
  ++fetch->attempts;
  running_[fetch->transfer] = {job, fetch, transport->second.get()};
  transport->second->start(fetch->transfer, job->describe(*fetch), now_);
  load = count_load();
}

void LoadEngine::schedule() {
  schedule_needed_ = false;
  next_ready_.reset();
  std::vector<Candidate> candidates;
  for (const auto& [id, job] : jobs_)
    for (const auto& fetch : job->fetches()) {
      if (!fetch->preempted && !job->ready(*fetch)) continue;
      if (fetch->not_before > now_)
        next_ready_ = next_ready_ ? std::min(*next_ready_, fetch->not_before) : fetch->not_before;
      else
        candidates.push_back({job.get(), fetch.get()});
    }
  // Requests with equal priority stay in order.
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.job->request().priority > b.job->request().priority;
  });
  Load load = count_load();
  for (std::size_t begin = 0; begin < candidates.size();) {
    std::size_t end = begin;
    const int priority = candidates[begin].job->request().priority;
    while (end < candidates.size() && candidates[end].job->request().priority == priority) ++end;
    schedule_equals(std::span(candidates).subspan(begin, end - begin), load);
    begin = end;
  }
}

/// Starts candidates of one priority. The viewport with the fewest transfers is next.
void LoadEngine::schedule_equals(std::span<const Candidate> candidates, Load& load) {
  std::map<std::uint32_t, std::deque<Candidate>> waiting;
  for (const Candidate& candidate : candidates) waiting[candidate.job->request().viewport].push_back(candidate);
  while (!waiting.empty()) {
    const auto next = std::min_element(waiting.begin(), waiting.end(), [&load](const auto& a, const auto& b) {
      return count_of(load.viewport, a.first) < count_of(load.viewport, b.first);
    });
    const Candidate candidate = next->second.front();
    next->second.pop_front();
    if (next->second.empty()) waiting.erase(next);
    if (candidate.job->over()) continue;
    const bool resumes = candidate.fetch->preempted;
    if (fits(*candidate.job, load) || (!resumes && make_room(*candidate.job, load))) let_run(candidate, load);
  }
}

std::optional<TimePoint> LoadEngine::next_deadline() const {
  std::optional<TimePoint> first = next_ready_;
  const auto consider = [&first](std::optional<TimePoint> time) {
    if (time && (!first || *time < *first)) first = time;
  };
  for (const auto& [kind, transport] : transports_) consider(transport->deadline(now_));
  if (!touched_.empty() || schedule_needed_) consider(now_);
  for (const RequestId id : pumping_)
    if (queue_.room(id) > 0) consider(now_);
  return first;
}

std::vector<int> LoadEngine::readable() const {
  std::vector<int> result;
  for (const auto& [kind, transport] : transports_)
    for (const int socket : transport->readable()) result.push_back(socket);
  return result;
}

}  // namespace gs::net
