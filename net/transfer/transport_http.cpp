#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <sys/socket.h>
#include <unistd.h>

#include "net/base/reference_policy.h"
#include "net/http/curl_library.h"
#include "net/http/http_headers.h"
#include "net/http/http_proxy.h"
#include "net/limits/shared_rate.h"
#include "net/transfer/curl_failures.h"
#include "net/transfer/idle_handles.h"
#include "net/transfer/ssh_transfers.h"
#include "net/transfer/transport.h"

namespace gs::net {
namespace {

/// Maximum bytes of an unneeded body (redirect or error) that are read to keep the connection open.
constexpr std::size_t kMaxDiscarded = std::size_t{16} << 10;
/// Bytes of a block. A compressed block is small, because it can grow a thousandfold and curl holds it while the queue
/// is full.
constexpr long kCompressedBlock = 16 << 10;
constexpr long kPlainBlock = 64 << 10;
/// Maximum time for which curl may block while it waits for an FTP server.
constexpr Milliseconds kLongestHold{1000};
/// With a rate limit: bytes that the system may buffer for a connection.
constexpr std::uint64_t kMinAhead = 4 << 10, kMaxAhead = 1 << 20;

class CurlTransport final : public HttpTransport {
 public:
  explicit CurlTransport(const LoaderOptions& options) : options_(options), rate_(options.bytes_per_second) {
    // With a bandwidth limit, connections need small receive buffers.
    if (options.bytes_per_second == 0) multi_ = idle_handles().take();
    if (!multi_) multi_ = new_handle();
  }
  ~CurlTransport() override {
    for (auto& [id, transfer] : transfers_) curl().curl_multi_remove_handle(multi_.get(), transfer->easy.get());
    if (multi_ && reusable_) idle_handles().keep(std::move(multi_));
  }

  void wait(Milliseconds time, std::span<const int> readable) override {
    std::vector<curl_waitfd> extra;
    for (const int socket : readable) extra.push_back({socket, CURL_WAIT_POLLIN, 0});
    curl().curl_multi_poll(multi_.get(), extra.data(), static_cast<unsigned>(extra.size()),
                           static_cast<int>(time.count()), nullptr);
  }
  void wake() override { curl().curl_multi_wakeup(multi_.get()); }
  void set_rate(std::uint64_t bytes_per_second) override { rate_.set(bytes_per_second); }

  void start(TransferId id, const TransferRequest& request, TimePoint now) override;
  void cancel(TransferId id) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) found->second->over = dirty_ = true;
  }
  void pause(TransferId id, bool paused) override {
    if (const auto found = transfers_.find(id); found != transfers_.end()) {
      found->second->wants_pause = paused;
      dirty_ = true;
    }
  }
  void step(TransferSink& sink, TimePoint now) override;
  [[nodiscard]] std::optional<TimePoint> deadline(TimePoint now) const override;

 private:
  struct Transfer {
    CurlTransport* transport = nullptr;
    TransferId id = 0;
    std::unique_ptr<CURL, FreeEasy> easy;
    std::unique_ptr<curl_slist, FreeList> headers;
    std::array<char, CURL_ERROR_SIZE> detail{};
    ResponseHead head;
    std::size_t header_bytes = 0, discarded = 0;
    TimePoint progress;                // time of the start, of the end of the headers, or of the last byte of the body
    std::optional<LoadError> failure;  // failure that this class found, not curl
    AddressSpace reach = AddressSpace::special;
    AddressSpace space = AddressSpace::special;  // space of the host
    std::string refused_host;                    // reason why an address of the host is refused
    std::string refused_url;                     // reason why no connection is opened
    bool proxied = false;                        // the proxy resolves the host
    bool by_ftp = false;
    std::shared_ptr<SshLink> ssh;  // null for other schemes
    Descriptor ssh_listener;       // for a new connection of curl to the link, until it is connected
    std::uint64_t left = 0;        // remaining bytes of an FTP file
    bool head_done = false, discarding = false, enough = false;
    bool wants_pause = false, paused = false, over = false;
    std::optional<TimePoint> slowed;  // start of the wait for the bandwidth limit

    /// Reports whether a transfer must be paused or resumed now. A transfer is never paused before its head: curl would
    /// hold back all other transfers to the host. Until then, curl does not know whether they can share the connection
    /// (CURLOPT_PIPEWAIT). on_body pauses such a transfer when its body begins.
    [[nodiscard]] bool pause_is_due() const { return wants_pause != paused && (head_done || !wants_pause); }
  };

  static std::size_t header_callback(char* data, std::size_t, std::size_t count, void* user) {
    auto& transfer = *static_cast<Transfer*>(user);
    return transfer.transport->on_header(transfer, {data, count}) ? count : 0;
  }
  static std::size_t write_callback(char* data, std::size_t, std::size_t count, void* user) {
    auto& transfer = *static_cast<Transfer*>(user);
    return transfer.transport->on_body(transfer, {data, count});
  }

  /// Refuses to connect to addresses that the document may not reach.
  static curl_socket_t open_socket_callback(void* user, curlsocktype, curl_sockaddr* address) {
    auto& transfer = *static_cast<Transfer*>(user);
    if (transfer.ssh) {
      transfer.transport->reusable_ = false;
      transfer.ssh_listener = listen_for_self(address->addr, address->addrlen);
      return transfer.ssh_listener ? ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0) : CURL_SOCKET_BAD;
    }
    if (!transfer.proxied && !transfer.transport->may_reach(transfer, ip_address_of(&address->addr)))
      return CURL_SOCKET_BAD;
    const int socket = ::socket(address->family, address->socktype | SOCK_CLOEXEC, address->protocol);
    // Limit the receive buffer: with a bandwidth limit, the system would otherwise receive data too early.
    if (const std::uint64_t rate = transfer.transport->rate_.bytes_per_second(); rate > 0 && socket >= 0) {
      const int room = static_cast<int>(std::clamp<std::uint64_t>(rate / 2, kMinAhead, kMaxAhead));
      (void)::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
      transfer.transport->reusable_ = false;
    }
    return socket;
  }
  /// Checks the host's address before each request, also on a reused connection.
  static int request_callback(void* user, char* address, char*, int, int) {
    auto& transfer = *static_cast<Transfer*>(user);
    if (transfer.proxied) return CURL_PREREQFUNC_OK;
    if (transfer.ssh)
      return connect_self(*transfer.ssh, transfer.ssh_listener) ? CURL_PREREQFUNC_OK : CURL_PREREQFUNC_ABORT;
    return transfer.transport->may_reach(transfer, ip_address_of(std::string(address ? address : "")))
               ? CURL_PREREQFUNC_OK
               : CURL_PREREQFUNC_ABORT;
  }

  static int progress_callback(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
    const auto& transfer = *static_cast<Transfer*>(user);
    return std::chrono::steady_clock::now() - transfer.transport->step_began_ > kLongestHold ? 1 : 0;
  }

  bool may_reach(Transfer& transfer, const std::optional<IpAddress>& address) const;
  void set_options(Transfer& transfer, const TransferRequest& request);
  void set_ftp_options(Transfer& transfer);
  void set_ssh_options(Transfer& transfer, const Url& url);
  bool on_header(Transfer& transfer, std::string_view line);
  bool tell_head(Transfer& transfer);
  bool begin_file(Transfer& transfer);
  std::size_t on_body(Transfer& transfer, std::string_view bytes);
  void apply_pauses();
  void go_on_at_rate();
  void end_refused();
  void collect();
  void watch_the_clock();
  void end(Transfer& transfer, const TransferEnd& how) {
    transfer.over = true;
    sink_->on_end(transfer.id, how);
  }
  void remove_over();
  [[nodiscard]] Milliseconds patience(const Transfer& transfer) const {
    // The server may encode a large file first. The link itself notices a lost connection.
    if (transfer.ssh && !transfer.head_done) return std::max<Milliseconds>(kEncodingTime, options_.head_timeout);
    return transfer.head_done ? options_.stall_timeout : options_.head_timeout;
  }

  const LoaderOptions& options_;
  MultiHandle multi_;
  std::unordered_map<TransferId, std::unique_ptr<Transfer>> transfers_;
  TransferSink* sink_ = nullptr;  // null outside of step()
  TimePoint now_{};
  std::chrono::steady_clock::time_point step_began_{};
  SharedRate rate_;
  bool dirty_ = false;    // step() is needed although no socket is ready
  bool reusable_ = true;  // no connection has a small receive buffer or belongs to an ssh link
};

void CurlTransport::start(TransferId id, const TransferRequest& request, TimePoint now) {
  auto transfer = std::make_unique<Transfer>();
  transfer->transport = this;
  transfer->id = id;
  transfer->progress = now;
  transfer->reach = request.reach;
  transfer->easy.reset(curl().curl_easy_init());
  set_options(*transfer, request);
  // A refused transfer is not started; it ends in the next step.
  if (transfer->refused_host.empty() && transfer->refused_url.empty())
    curl().curl_multi_add_handle(multi_.get(), transfer->easy.get());
  transfers_[id] = std::move(transfer);
  dirty_ = true;
}

bool CurlTransport::may_reach(Transfer& transfer, const std::optional<IpAddress>& address) const {
  const AddressSpace space = address ? options_.space_of(*address) : AddressSpace::special;
  const auto why = refuse_host(transfer.reach, space, address ? address_text(*address) : std::string());
  transfer.refused_host = why.value_or("");
  transfer.space = space;
  return !why;
}

void CurlTransport::set_options(Transfer& transfer, const TransferRequest& request) {
  CURL* const easy = transfer.easy.get();
  const auto canonical = canonical_url(parse_url(request.url));
  // Refuse a URL without a host, because curl would take the host from the path.
  if (!canonical) {
    transfer.refused_url = "it has no host or an invalid port";
    return;
  }
  if (canonical->scheme == "ssh") set_ssh_options(transfer, *canonical);
  if (!transfer.refused_url.empty()) return;
  const std::string url = transfer.ssh ? http_of_ssh(*canonical) : canonical->text();
  curl().curl_easy_setopt(easy, CURLOPT_URL, url.c_str());
  transfer.by_ftp = canonical->scheme == "ftp";
  curl().curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, transfer.by_ftp ? "ftp" : "http,https");
  // The loader follows redirects, because it checks each redirect and searches the cache for its target.
  curl().curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
  curl().curl_easy_setopt(easy, CURLOPT_HTTP_VERSION,
                          static_cast<long>(transfer.ssh ? CURL_HTTP_VERSION_1_1 : CURL_HTTP_VERSION_2TLS));
  curl().curl_easy_setopt(easy, CURLOPT_PIPEWAIT, canonical->scheme == "https" ? 1L : 0L);
  curl().curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
  curl().curl_easy_setopt(easy, CURLOPT_QUICK_EXIT, 1L);  // do not wait for a name server when a transfer ends
  curl().curl_easy_setopt(easy, CURLOPT_SUPPRESS_CONNECT_HEADERS, 1L);
  curl().curl_easy_setopt(easy, CURLOPT_TCP_KEEPALIVE, 1L);
  curl().curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(options_.connect_timeout.count()));
  curl().curl_easy_setopt(easy, CURLOPT_USERAGENT, options_.user_agent.c_str());
  curl().curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, transfer.detail.data());
  curl().curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, &write_callback);
  curl().curl_easy_setopt(easy, CURLOPT_WRITEDATA, &transfer);
  curl().curl_easy_setopt(easy, CURLOPT_PRIVATE, &transfer);
  if (!options_.ca_file.empty()) curl().curl_easy_setopt(easy, CURLOPT_CAINFO, options_.ca_file.c_str());
  // A proxy would answer FTP with HTTP, so use none for FTP.
  const bool may_proxy = options_.proxy_from_environment && !transfer.by_ftp && !transfer.ssh;
  const std::string proxy = may_proxy ? proxy_of(*canonical) : std::string();
  curl().curl_easy_setopt(easy, CURLOPT_PROXY, proxy.c_str());
  curl().curl_easy_setopt(easy, CURLOPT_NOPROXY, "");
  transfer.proxied = !proxy.empty();
  if (transfer.proxied) {
    transfer.space = space_by_name(url, options_.space_of);
    transfer.refused_host = refuse_host(transfer.reach, transfer.space).value_or("");
  }
  curl().curl_easy_setopt(easy, CURLOPT_OPENSOCKETFUNCTION, &open_socket_callback);
  curl().curl_easy_setopt(easy, CURLOPT_OPENSOCKETDATA, &transfer);
  curl().curl_easy_setopt(easy, CURLOPT_PREREQFUNCTION, &request_callback);
  curl().curl_easy_setopt(easy, CURLOPT_PREREQDATA, &transfer);
  if (transfer.by_ftp) return set_ftp_options(transfer);
  curl().curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, &header_callback);
  curl().curl_easy_setopt(easy, CURLOPT_HEADERDATA, &transfer);

  const auto add = [&transfer](const std::string& name, const std::string& value) {
    if (value.empty() || !is_field_value(value)) return;
    transfer.headers.reset(curl().curl_slist_append(transfer.headers.release(), (name + ": " + value).c_str()));
  };
  if (request.range) {
    const bool open = request.range->end == kOpenEnd;
    add("Range", "bytes=" + std::to_string(request.range->begin) + "-" +
                     (open ? std::string() : std::to_string(request.range->end - 1)));
    add("If-Range", request.if_range);
    // Request ranges uncompressed: byte ranges of compressed data are useless.
    add("Accept-Encoding", "identity");
    curl().curl_easy_setopt(easy, CURLOPT_BUFFERSIZE, rate_.block_size(kPlainBlock));
  } else {
    // Request only encodings with a bounded growth per block.
    curl().curl_easy_setopt(easy, CURLOPT_ACCEPT_ENCODING, "gzip, deflate");
    curl().curl_easy_setopt(easy, CURLOPT_BUFFERSIZE, rate_.block_size(kCompressedBlock));
  }
  add("If-None-Match", request.if_none_match);
  add("If-Modified-Since", request.if_modified_since);
  add("Accept", request.accept);
  add("Authorization", request.authorization);
  if (request.post) {
    curl().curl_easy_setopt(easy, CURLOPT_POST, 1L);
    curl().curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE, 0L);
    curl().curl_easy_setopt(easy, CURLOPT_POSTFIELDS, "");
  }
  if (transfer.ssh) add(kWithinField, request.within);
  curl().curl_easy_setopt(easy, CURLOPT_HTTPHEADER, transfer.headers.get());
}

/// Sets options for HTTP over ssh. The name of the link keeps connections of different links apart.
void CurlTransport::set_ssh_options(Transfer& transfer, const Url& url) {
  CURL* const easy = transfer.easy.get();
  transfer.refused_url = find_ssh_link(url, options_, transfer.ssh).value_or("");
  if (!transfer.ssh) return;
  transfer.space = kSshSpace;
  curl().curl_easy_setopt(easy, CURLOPT_ABSTRACT_UNIX_SOCKET, ssh_socket_name(*transfer.ssh).c_str());
}

/// Sets options for FTP: anonymous (RFC 1635), whole files (RFC 959), passive mode (RFC 2428), one file per connection.
void CurlTransport::set_ftp_options(Transfer& transfer) {
  CURL* const easy = transfer.easy.get();
  curl().curl_easy_setopt(easy, CURLOPT_FTP_FILEMETHOD, static_cast<long>(CURLFTPMETHOD_NOCWD));
  curl().curl_easy_setopt(easy, CURLOPT_FTP_SKIP_PASV_IP, 1L);
  curl().curl_easy_setopt(easy, CURLOPT_FORBID_REUSE, 1L);
  curl().curl_easy_setopt(easy, CURLOPT_BUFFERSIZE, rate_.block_size(kPlainBlock));
  curl().curl_easy_setopt(easy, CURLOPT_NOPROGRESS, 0L);
  curl().curl_easy_setopt(easy, CURLOPT_XFERINFOFUNCTION, &progress_callback);
  curl().curl_easy_setopt(easy, CURLOPT_XFERINFODATA, &transfer);
}

bool CurlTransport::on_header(Transfer& transfer, std::string_view line) {
  if (transfer.over) return false;
  if (transfer.head_done) return true;  // ignore trailers of the body
  transfer.header_bytes += line.size();
  if (transfer.header_bytes > options_.max_header_bytes) {
    transfer.failure =
        LoadError{LoadErrorKind::bad_response,
                  "the server sent more than " + std::to_string(options_.max_header_bytes) + " bytes of headers", 0};
    return false;
  }
  if (line.starts_with("HTTP/")) {
    transfer.head = {};
    long status = 0;
    curl().curl_easy_getinfo(transfer.easy.get(), CURLINFO_RESPONSE_CODE, &status);
    transfer.head.status = static_cast<int>(status);
    return true;
  }
  if (line != "\r\n" && line != "\n") {
    const std::size_t colon = std::min(line.find(':'), line.size());
    add_header(transfer.head, line.substr(0, colon), line.substr(std::min(colon + 1, line.size())),
               options_.unix_seconds());
    return true;
  }
  if (transfer.head.status < 200) return true;  // the final head follows
  finish_head(transfer.head);
  return tell_head(transfer);
}

/// Starts the body of an FTP file. FTP has no head; the server only reports the length (SIZE, RFC 3659). With the
/// length, the transfer ends without waiting for the server's last reply. During that wait, curl would block all other
/// transfers.
bool CurlTransport::begin_file(Transfer& transfer) {
  curl_off_t size = -1;
  curl().curl_easy_getinfo(transfer.easy.get(), CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &size);
  if (size < 0) {
    transfer.failure = LoadError{LoadErrorKind::bad_response,
                                 "the server does not support SIZE, which gives the length of the file", 0};
    return false;
  }
  transfer.left = static_cast<std::uint64_t>(size);
  transfer.head.status = 200;
  transfer.head.content_length = transfer.left;
  return tell_head(transfer);
}

bool CurlTransport::tell_head(Transfer& transfer) {
  transfer.head.space = transfer.space;
  transfer.head_done = true;
  transfer.progress = now_;
  const HeadVerdict verdict = sink_->on_head(transfer.id, transfer.head);
  transfer.discarding = verdict == HeadVerdict::discard;
  transfer.over |= verdict == HeadVerdict::stop;
  return !transfer.over;
}

std::size_t CurlTransport::on_body(Transfer& transfer, std::string_view bytes) {
  if (transfer.over || (transfer.by_ftp && !transfer.head_done && !begin_file(transfer))) return 0;
  if (transfer.by_ftp) bytes = bytes.substr(0, transfer.left);
  if (transfer.wants_pause) {
    transfer.paused = true;
    return CURL_WRITEFUNC_PAUSE;
  }
  if (!rate_.admits(now_)) {
    transfer.slowed = now_;
    return CURL_WRITEFUNC_PAUSE;
  }
  rate_.use(bytes.size(), now_);
  transfer.progress = now_;
  if (transfer.discarding) {
    transfer.discarded += bytes.size();
    transfer.enough = transfer.discarded > kMaxDiscarded;
    return transfer.enough ? 0 : bytes.size();
  }
  const DataVerdict verdict = sink_->on_data(transfer.id, std::as_bytes(std::span(bytes)));
  transfer.over |= verdict == DataVerdict::stop;
  transfer.wants_pause |= verdict == DataVerdict::pause;
  transfer.left -= transfer.by_ftp ? bytes.size() : 0;
  transfer.enough = transfer.by_ftp && transfer.left == 0;
  return transfer.over || transfer.enough ? 0 : bytes.size();
}

void CurlTransport::apply_pauses() {
  for (auto& [id, transfer] : transfers_) {
    if (transfer->over || !transfer->pause_is_due()) continue;
    transfer->paused = transfer->wants_pause;
    transfer->slowed.reset();
    transfer->progress = now_;
    // curl_easy_pause may deliver bytes that curl held, and on_body may then pause the transfer again.
    curl().curl_easy_pause(transfer->easy.get(), transfer->paused ? CURLPAUSE_RECV : CURLPAUSE_CONT);
  }
}

// Resumes transfers that wait for the bandwidth limit, one block each. The transfer that waited longest is first.
void CurlTransport::go_on_at_rate() {
  while (rate_.admits(now_)) {
    Transfer* first = nullptr;
    for (auto& [id, transfer] : transfers_)
      if (!transfer->over && !transfer->paused && transfer->slowed && (!first || transfer->slowed < first->slowed))
        first = transfer.get();
    if (!first) return;
    first->slowed.reset();
    first->progress = now_;
    curl().curl_easy_pause(first->easy.get(), CURLPAUSE_CONT);
  }
}

void CurlTransport::step(TransferSink& sink, TimePoint now) {
  sink_ = &sink;
  now_ = now;
  dirty_ = false;
  rate_.follow(now_);
  remove_over();
  apply_pauses();
  go_on_at_rate();
  int running = 0;
  step_began_ = std::chrono::steady_clock::now();
  curl().curl_multi_perform(multi_.get(), &running);
  end_refused();
  collect();
  watch_the_clock();
  remove_over();
  sink_ = nullptr;
}

/// Ends the transfers that were refused at their start.
void CurlTransport::end_refused() {
  for (auto& [id, transfer] : transfers_)
    if (!transfer->over && !transfer->refused_url.empty())
      end(*transfer, {LoadError{LoadErrorKind::forbidden, transfer->refused_url, 0}, false});
    else if (!transfer->over && transfer->proxied && !transfer->refused_host.empty())
      end(*transfer, {LoadError{LoadErrorKind::forbidden, transfer->refused_host, 0}, false});
}

void CurlTransport::collect() {
  int left = 0;
  while (const CURLMsg* const message = curl().curl_multi_info_read(multi_.get(), &left)) {
    if (message->msg != CURLMSG_DONE) continue;
    void* user = nullptr;
    curl().curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &user);
    auto& transfer = *static_cast<Transfer*>(user);
    if (transfer.over) continue;
    const CURLcode code = message->data.result;
    if (transfer.failure)
      end(transfer, {transfer.failure, false});
    else if (transfer.enough || (code == CURLE_OK && transfer.head_done))
      end(transfer, {});
    else if (code == CURLE_OK && transfer.by_ftp && begin_file(transfer))
      end(transfer, {});  // the file is empty
    else if (code == CURLE_OK)
      end(transfer, {LoadError{LoadErrorKind::bad_response, "the server sent an incomplete header", 0}, false});
    else if (!transfer.head_done && !transfer.refused_host.empty())
      end(transfer, {LoadError{LoadErrorKind::forbidden, transfer.refused_host, 0}, false});
    else if (const auto failure = transfer.ssh ? transfer.ssh->failure() : std::nullopt)
      end(transfer, describe_ssh_failure(*failure));
    else
      end(transfer, describe_failure(code, transfer.ssh ? std::string() : transfer.detail.data(), options_));
  }
}

void CurlTransport::watch_the_clock() {
  for (auto& [id, transfer] : transfers_) {
    // ssh may ask the user for a password.
    if (transfer->ssh && transfer->ssh->connecting()) transfer->progress = now_;
    const bool held_back = transfer->paused || transfer->slowed || (transfer->wants_pause && transfer->head_done);
    if (transfer->over || held_back || now_ - transfer->progress < patience(*transfer)) continue;
    const std::string what =
        transfer->head_done ? "no byte of the body was received within " : "no complete header was received within ";
    end(*transfer, {LoadError{LoadErrorKind::timed_out, what + milliseconds(patience(*transfer)), 0}, true});
  }
}

void CurlTransport::remove_over() {
  std::erase_if(transfers_, [this](const auto& entry) {
    if (entry.second->over) curl().curl_multi_remove_handle(multi_.get(), entry.second->easy.get());
    return entry.second->over;
  });
}

std::optional<TimePoint> CurlTransport::deadline(TimePoint now) const {
  std::optional<TimePoint> first;
  for (const auto& [id, transfer] : transfers_) {
    if (transfer->over || transfer->pause_is_due()) return now;
    if (transfer->paused) continue;
    const TimePoint time = transfer->slowed ? rate_.next(now) : transfer->progress + patience(*transfer);
    if (!first || time < *first) first = time;
  }
  return dirty_ ? std::optional(now) : first;
}

}  // namespace

std::unique_ptr<HttpTransport> make_http_transport(const LoaderOptions& options) {
  return curl().problem.empty() ? std::make_unique<CurlTransport>(options) : nullptr;
}

}  // namespace gs::net
