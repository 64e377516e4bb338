#include "app/insitu/publisher.h"

#include "app/insitu/arrays/value_colors.h"
#include "net/control/control_token.h"
#include "net/control/live_file.h"
#include "net/files/file.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

namespace gs::app::insitu {
namespace {

// Minimum number of steps that a temporary folder keeps, and bytes above which it drops older steps. Viewers may still
// read a step after a newer one appeared.
constexpr std::size_t kMinKeptSteps = 3;
constexpr std::uint64_t kMaxKeptBytes = std::uint64_t{64} << 20;
// Time after the last request for which a viewer counts as present.
constexpr std::chrono::seconds kViewerStays{45};
constexpr std::string_view kTemporaryPrefix = "ghostspace-insitu-";

std::int64_t insitu_now() { return std::chrono::steady_clock::now().time_since_epoch().count(); }

// Escapes a text for use inside the quotes of a VRML97 string.
std::string vrml_text(std::string_view text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) >= ' ') quoted += c;
  }
  return quoted;
}

// Returns the parent folder for temporary streams, in memory if possible.
std::string temporary_parent() {
  constexpr const char* kMemory = "/dev/shm";
  if (::access(kMemory, W_OK | X_OK) == 0) return kMemory;
  if (const char* chosen = std::getenv("TMPDIR"); chosen && chosen[0] == '/') return chosen;
  return "/tmp";
}

net::ServedType insitu_type_of(const std::string& name) {
  if (name.ends_with(".qnv")) return {"model/x-qnv", false};
  if (name.ends_with(".wrl")) return {"model/vrml", false};
  return {};
}

}  // namespace

std::string stream_file_name(const StepStream& stream, std::int64_t step, const std::vector<std::string>& taken) {
  constexpr const char *kStreamEnd = ".qnv", *kContainerEnd = ".zarr";
  std::string name = stream.field.empty() ? name_of(stream.kind) : stream.field;
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_')) c = '_';
  if (stream.kind != StreamKind::volume && !stream.field.empty()) name += std::string("-") + name_of(stream.kind);
  char number[32];
  std::snprintf(number, sizeof number, ".%06lld%s", static_cast<long long>(step),
                stream.served ? kContainerEnd : kStreamEnd);
  std::string file = name + number;
  for (int i = 2; std::ranges::find(taken, file) != taken.end(); ++i) file = name + "-" + std::to_string(i) + number;
  return file;
}

std::string world_of_streams(const std::string& title, std::int64_t step, double time,
                             const std::vector<StepStream>& streams, const std::vector<std::string>& files) {
  std::string world = "#VRML V2.0 utf8\nWorldInfo {\n  title \"" + vrml_text(title) + ", step " + std::to_string(step) +
                      ", time " + number_text(time) + "\"\n  info [ \"live data: " + kLiveJson + "\" ]\n}\n";
  // Several volumes would hide each other, so the world shows the first one.
  bool volume = false;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const bool is_volume = streams[i].kind == StreamKind::volume;
    if (is_volume && volume) continue;
    volume = volume || is_volume;
    world += "Shape {\n  appearance Appearance { material Material {} }\n  geometry QNV { url \"" + files[i] + "\"" +
             (is_volume ? " profile \"VOLUME\"" : "") + " }\n}\n";
  }
  return world;
}

std::variant<std::unique_ptr<Publisher>, std::string> Publisher::start(PublisherOptions options,
                                                                       Parameters& parameters) {
  std::unique_ptr<Publisher> made(new Publisher(std::move(options), parameters));
  if (made->options_.folder.empty()) {
    const std::string parent = temporary_parent();
    (void)net::remove_abandoned_folders(parent, kTemporaryPrefix);  // left by killed simulations
    auto folder = net::LockedFolder::make(parent, kTemporaryPrefix);
    if (auto* problem = std::get_if<std::string>(&folder)) return std::move(*problem);
    made->temporary_ = std::move(std::get<net::LockedFolder>(folder));
    made->folder_ = made->temporary_.path() + '/';
  } else {
    std::error_code error;
    std::filesystem::create_directories(made->options_.folder, error);
    if (!std::filesystem::is_directory(made->options_.folder, error))
      return made->options_.folder + ": the folder cannot be created; expected a writable place";
    made->folder_ = made->options_.folder + '/';
  }
  made->world_ = world_of_streams(made->options_.title, 0, 0, {}, {});
  made->about_ = JsonValue::named({{"version", 1}, {"title", made->options_.title}});
  if (made->options_.serve)
    if (auto problem = made->start_server()) return std::move(*problem);
  return made;
}

Publisher::~Publisher() {
  server_.reset();
  if (!token_file_.empty()) (void)::unlink(token_file_.c_str());
  if (!has_live_file_) return;
  // A later run may have replaced the file.
  const auto file = net::read_live_file(options_.live_file);
  if (const auto* const own = std::get_if<net::LiveFile>(&file); own && own->token == token_)
    (void)::unlink(options_.live_file.c_str());
}

std::optional<std::string> Publisher::start_server() {
  net::HttpServerOptions http;
  http.folder = folder_;
  http.bind = options_.bind;
  http.port = options_.port;
  // Charges the processor time since the previous request, which includes the transfer of the previous answer.
  http.type_of = [this](const std::string& name) {
    charge();
    note_file(name);
    return insitu_type_of(name);
  };
  http.list = [this](const net::FolderListing&, const net::FolderRequest&) {
    charge();
    note_viewer();
    const std::lock_guard lock(mutex_);
    return net::FolderPage{"model/vrml", world_};
  };
  http.content = [this](const net::ContentRequest& request) {
    net::HeldContent held = shelf_.content(request.path);
    if (held.state != net::HeldContent::State::none) note_viewer();
    return held;
  };
  http.missing = [this](const std::string& name, const net::FolderRequest&) -> std::optional<net::FolderPage> {
    if (name != kLiveJson) return std::nullopt;
    charge();
    note_viewer();
    return net::FolderPage{"application/json", json()};
  };
  http.post = [this](const net::PostRequest& request) { return post(request); };
  token_ = net::make_control_token();
  auto started = net::HttpServer::start(std::move(http));
  if (auto* problem = std::get_if<net::HttpServerError>(&started)) return std::move(problem->message);
  server_ = std::move(std::get<std::unique_ptr<net::HttpServer>>(started));
  if (auto problem = write_token(server_->port())) return problem;
  return write_address(server_->port());
}

std::optional<std::string> Publisher::write_token(std::uint16_t port) {
  const bool chosen = !options_.token_file.empty();
  const std::string path = chosen ? options_.token_file : net::usual_token_file(port);
  if (path.empty()) return std::nullopt;  // without a home folder, steering is not possible
  std::error_code error;
  if (!chosen) std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
  if (auto problem = net::write_control_token(path, token_)) {
    if (chosen) return problem;
    return std::nullopt;
  }
  token_file_ = path;
  return std::nullopt;
}

std::optional<std::string> Publisher::write_address(std::uint16_t port) {
  if (options_.live_file.empty()) return std::nullopt;
  auto problem = net::write_live_file(options_.live_file, {net::name_of_machine(), options_.bind, port, token_});
  has_live_file_ = !problem;
  return problem;
}

std::string Publisher::json() const {
  JsonValue all;
  {
    const std::lock_guard lock(mutex_);
    all = about_;
  }
  parameters_.describe(all);
  return all.json();
}

net::PostAnswer Publisher::post(const net::PostRequest& request) {
  if (request.path != "/parameters") return {404, "not found; expected /parameters"};
  constexpr std::string_view kBearer = "Bearer ";
  const std::string_view given = request.authorization;
  if (!given.starts_with(kBearer) || !net::same_secret(given.substr(kBearer.size()), token_))
    return {403, "the token is wrong or missing; expected the token of this session"};
  if (const auto problem = parameters_.set_wanted(request.query)) return {400, *problem};
  seen_ = true;  // the changed parameters make a new step worth showing
  note_viewer();
  return {200, "ok"};
}

void Publisher::note_viewer() { viewer_ = insitu_now(); }

void Publisher::note_file(std::string_view name) {
  note_viewer();
  if (seen_ || !name.ends_with(".qnv")) return;
  const std::lock_guard lock(mutex_);
  if (world_.find('"' + std::string(name) + '"') != std::string::npos) seen_ = true;
}

bool Publisher::is_wanted() const {
  if (!options_.folder.empty()) return true;
  if (!options_.serve) return false;
  {
    const std::lock_guard lock(mutex_);
    if (kept_.empty()) return true;  // so that the first viewer finds a step
  }
  if (!has_viewer()) return false;
  if (seen_) return true;
  {
    const std::lock_guard lock(mutex_);
    if (!shelved_) return false;
  }
  return shelf_.is_seen() && !shelf_.is_busy(BrickShelf::Clock::now());
}

bool Publisher::has_viewer() const {
  const std::int64_t last = viewer_;
  return last != INT64_MIN && insitu_now() - last < std::chrono::nanoseconds(kViewerStays).count();
}

void Publisher::deliver(const WantedChunk& wanted, std::vector<float> values) {
  shelf_.deliver(wanted, std::move(values));
  if (server_) server_->wake();
}

std::optional<std::string> Publisher::publish(std::int64_t step, double time, std::vector<StepStream> streams) {
  if (streams.empty()) return std::nullopt;
  Kept kept;
  JsonValue list = JsonValue::list();
  bool shelved = false;
  for (const StepStream& stream : streams) {
    std::string name = stream_file_name(stream, step, kept.files);
    if (stream.served) {
      stream.served->container = name;
      name += "/zarr.json";
      shelf_.put(std::move(*stream.served));
      shelved = true;
      kept.files.push_back(name);
      list.add(JsonValue::named({{"kind", name_of(stream.kind)},
                                 {"field", stream.field},
                                 {"unit", stream.unit},
                                 {"url", name},
                                 {"max_error", stream.max_error},
                                 {"thinning", stream.thinning}}));
      continue;
    }
    auto failed = net::write_file_atomically(folder_ + name, stream.bytes);
    if (failed && make_room()) failed = net::write_file_atomically(folder_ + name, stream.bytes);
    if (failed) {
      if (options_.folder.empty()) remove_files(kept);
      return std::move(failed->message);
    }
    kept.files.push_back(name);
    kept.bytes += stream.bytes.size();
    list.add(JsonValue::named({{"kind", name_of(stream.kind)},
                               {"field", stream.field},
                               {"unit", stream.unit},
                               {"url", name},
                               {"bytes", stream.bytes.size()},
                               {"max_error", stream.max_error},
                               {"thinning", stream.thinning}}));
  }
  std::string world = world_of_streams(options_.title, step, time, streams, kept.files);
  if (!options_.folder.empty())
    if (auto failed = net::write_file_atomically(folder_ + kLiveWorld, std::as_bytes(std::span(world))))
      return std::move(failed->message);
  const std::lock_guard lock(mutex_);
  world_ = std::move(world);
  about_.put("step", step);
  about_.put("time", time);
  about_.put("streams", std::move(list));
  kept_.push_back(std::move(kept));
  shelved_ = shelved;
  seen_ = false;
  drop_old();
  return std::nullopt;
}

// Removes old streams from a temporary folder. Running transfers keep their open files.
void Publisher::drop_old() {
  std::uint64_t bytes = 0;
  for (const Kept& kept : kept_) bytes += kept.bytes;
  // Steps without files are on the shelf only.
  while (kept_.size() > kMinKeptSteps &&
         (!options_.folder.empty() || bytes > kMaxKeptBytes || kept_.front().bytes == 0)) {
    bytes -= kept_.front().bytes;
    if (options_.folder.empty()) remove_files(kept_.front());
    kept_.pop_front();
  }
}

// Removes all steps but the newest from a temporary folder. Returns false if there are none.
bool Publisher::make_room() {
  const std::lock_guard lock(mutex_);
  if (!options_.folder.empty() || kept_.size() < 2) return false;
  for (; kept_.size() > 1; kept_.pop_front()) remove_files(kept_.front());
  return true;
}

void Publisher::remove_files(const Kept& kept) const {
  for (const std::string& name : kept.files) (void)::unlink((folder_ + name).c_str());
}

}  // namespace gs::app::insitu
