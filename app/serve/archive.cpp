#include "app/serve/archive.h"

#include "app/formats/content_types.h"
#include "app/formats/streamed_names.h"
#include "app/serve/archive_index.h"
#include "app/serve/cell_archive.h"
#include "app/serve/child_program.h"
#include "app/serve/folder_world.h"
#include "net/base/descriptor_limit.h"
#include "net/base/host_names.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

// Maximum wait of the user of an account for a made file.
constexpr std::chrono::minutes kOwnWait{30};

// Runs the program that makes a file, in a separate process without network and with access only to the served folder.
// This confinement is needed because files and clients are untrusted.
std::optional<net::MakeFailure> run_confined(const std::string& program, const std::string& served,
                                             std::vector<std::string> arguments, const ChildLimits& limits,
                                             const std::stop_token& stop) {
  arguments.insert(std::find(arguments.begin(), arguments.end(), "--"),
                   {"--offline", "--allow", served, "--confine", served});
  const auto failure = run_child(program, arguments, limits, stop);
  if (!failure) return std::nullopt;
  return net::MakeFailure{failure->message, failure->lasting};
}

// Returns the folder that a program may read to make a file from `source`. In an account that is served as a whole,
// this is the folder of the file.
std::string readable_folder(const std::string& source, const std::string& served) {
  return served.empty() ? fs::path(source).parent_path().string() : served;
}

net::Maker thumbnail_maker(const std::string& program, const std::string& served) {
  net::Maker maker;
  maker.name = "thumbnail";
  maker.type.mime = "image/png";
  maker.extension = ".png";
  maker.wait = std::chrono::seconds(60);
  maker.source_of = [](const std::string& name, const std::string& query) -> std::optional<std::string> {
    if (query != "thumbnail" || !content_type_by_name(name)) return std::nullopt;
    return name;
  };
  maker.make = [program, served](const std::string& source, const std::string& out, const std::stop_token& stop) {
    ChildLimits limits;
    limits.time = std::chrono::seconds(60);
    return run_confined(program, readable_folder(source, served),
                        {"--snapshot", out, "--size", "320x240", "--timeout", "15", "--", source}, limits, stop);
  };
  return maker;
}

// Returns a maker of streams that are requested by names of their own. It lacks its functions.
net::Maker maker_of_streams(std::string name, std::size_t at_once) {
  net::Maker maker;
  maker.name = std::move(name);
  maker.type.mime = "model/x-qnv";
  maker.extension = ".qnv";
  maker.for_missing = true;
  maker.at_once = at_once;
  return maker;
}

net::Maker stream_maker(const std::string& program, const std::string& served) {
  net::Maker maker = maker_of_streams("encode", 1);  // one at a time, because each may need gigabytes of memory
  maker.source_of = [](const std::string& name, const std::string&) -> std::optional<std::string> {
    const std::string source = name.ends_with(".qnv") ? name.substr(0, name.size() - 4) : std::string();
    if (!can_be_encoded(source)) return std::nullopt;
    return source;
  };
  maker.make = [program, served](const std::string& source, const std::string& out, const std::stop_token& stop) {
    ChildLimits limits;
    limits.time = std::chrono::minutes(30);
    limits.memory = std::uint64_t{8} << 30;
    return run_confined(program, readable_folder(source, served), {"encode", "--timeout", "600", "--", source, out},
                        limits, stop);
  };
  return maker;
}

// Returns the maker of coarse streams, which clients show while the server encodes the complete volumes.
net::Maker coarse_maker(const std::string& program, const std::string& served) {
  net::Maker maker = maker_of_streams("coarse", 2);
  maker.coarse_of = "encode";
  maker.source_of = [](const std::string& name, const std::string&) -> std::optional<std::string> {
    if (!name.ends_with(kCoarseExtension)) return std::nullopt;
    const std::string source = name.substr(0, name.size() - kCoarseExtension.size());
    const ContentType* const type = content_type_by_name(source);
    return type && type->content == ContentClass::volume ? std::optional(source) : std::nullopt;
  };
  maker.make = [program, served](const std::string& source, const std::string& out, const std::stop_token& stop) {
    ChildLimits limits;
    limits.time = std::chrono::minutes(2);
    return run_confined(
        program, readable_folder(source, served),
        {"encode", "--most-voxels", "1M", "--error", "0.5%", "--parity", "0", "--timeout", "100", "--", source, out},
        limits, stop);
  };
  return maker;
}

// Creates the folder for made files. Returns the error, or nullopt. An empty `served` means all files.
std::optional<std::string> prepare(const std::string& cache, const std::string& served) {
  std::error_code error;
  fs::create_directories(cache, error);
  if (error || !fs::is_directory(cache, error)) return cache + ": the cache folder cannot be created";
  fs::permissions(cache, fs::perms::owner_all, error);
  if (served.empty()) return std::nullopt;
  const std::string inner = fs::canonical(cache, error).string();
  const std::string outer = error ? std::string() : fs::canonical(served, error).string();
  if (error) return served + ": cannot be found: " + error.message();
  if (inner == outer || inner.starts_with(outer == "/" ? outer : outer + "/"))
    return cache + " is inside the served folder; expected another folder for the cache";
  return std::nullopt;
}

// Sets the options of a server without a port: its only client is the user of this account.
void serve_connected(net::HttpServerOptions& http, bool whole) {
  http.bind = "*";  // the other end may use any name
  http.listen = false;
  http.patient = true;
  http.limits.requests_per_second = 0;
  if (!whole) return;
  http.to_owner = true;
  if (const char* home = std::getenv("HOME"); home && home[0] == '/') http.home = home;
}

// Returns the number of connections that the descriptor limit permits, at most `wanted`. Each needs two descriptors.
std::size_t possible_connections(std::size_t wanted) {
  constexpr std::size_t kOtherDescriptors = 128;
  const std::size_t limit = net::raise_descriptor_limit(2 * wanted + kOtherDescriptors);
  return std::min(wanted, (limit - std::min(limit, kOtherDescriptors)) / 2);
}

std::string cell_metrics(const net::CellServerStatistics& cells) {
  std::string text;
  const auto add = [&text](const std::string& name, const char* type, std::uint64_t value) {
    text += "# TYPE ghostspace_cells_" + name + " " + type + "\nghostspace_cells_" + name + " " +
            std::to_string(value) + "\n";
  };
  add("clients", "gauge", cells.clients);
  add("sessions_total", "counter", cells.accepted);
  add("refused_total", "counter", cells.refused);
  add("foreign_datagrams_total", "counter", cells.foreign);
  add("datagrams_total", "counter", cells.datagrams);
  add("sent_bytes_total", "counter", cells.bytes);
  add("parity_datagrams_total", "counter", cells.parity_datagrams);
  add("parity_bytes_total", "counter", cells.parity_bytes);
  return text;
}

}  // namespace

std::string archive_cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && cache[0] == '/')
    return std::string(cache) + "/ghostspace/archive";
  if (const char* home = std::getenv("HOME"); home && home[0] == '/')
    return std::string(home) + "/.cache/ghostspace/archive";
  return {};
}

std::variant<std::unique_ptr<Archive>, std::string> Archive::start(const ArchiveOptions& options) {
  std::error_code folder_error;
  const bool whole = options.folder.empty() && options.standard_streams;
  if (!whole && !fs::is_directory(options.folder, folder_error))
    return options.folder + (fs::exists(options.folder, folder_error) ? ": not a folder" : ": no such folder") +
           "; expected a folder to serve";
  std::unique_ptr<Archive> archive(new Archive());
  const bool both = options.http_port && options.cells_port;
  const std::uint64_t rate = both ? options.rate / 2 : options.rate;
  if (options.cells_port) {
    auto library = CellArchive::of_folder(options.folder);
    if (auto* problem = std::get_if<std::string>(&library)) return *problem;
    net::CellServerOptions cells;
    if (rate > 0) {
      cells.total_rate = rate;
      cells.client_rate = rate;
    }
    cells.session.response = options.congestion;
    if (options.bind != "*" && options.bind != "127.0.0.1" && options.bind != "::1")
      return "cells are served on 127.0.0.1 or on all interfaces ('*') only, not on " + options.bind;
    auto started = net::CellServerDriver::start(cells, std::get<std::shared_ptr<CellArchive>>(library),
                                                *options.cells_port, options.bind != "*");
    if (auto* problem = std::get_if<net::UdpError>(&started)) return problem->message;
    archive->cells_ = std::move(std::get<std::unique_ptr<net::CellServerDriver>>(started));
  }
  if (!options.http_port && !options.standard_streams) return archive;
  net::HttpServerOptions http;
  http.folder = whole ? "/" : options.folder;
  http.bind = options.bind;
  http.port = options.http_port.value_or(0);
  if (options.standard_streams) serve_connected(http, whole);
  http.limits.total_rate = rate / 8;
  http.limits.connections = possible_connections(options.connections);
  if (http.limits.connections == 0) return "the limit of open files is too low (ulimit -n); expected at least 256";
  if (http.limits.connections < options.connections && options.report)
    options.report("ghostspace: the limit of open files allows " + std::to_string(http.limits.connections) +
                   " connections; raise it with ulimit -n");
  http.max_age = options.max_age;
  http.type_of = served_type_of;
  http.host_names = options.host_names;
  http.proxies = options.proxies;
  const auto address = net::ip_address_of(options.bind);
  const bool for_us_alone = options.standard_streams || (address && net::is_loopback(*address));
  http.origins = options.origins.value_or(for_us_alone ? std::vector<std::string>() : std::vector<std::string>{"*"});
  http.made_folder = options.cache.empty() ? archive_cache_folder() : options.cache;
  const bool make = options.make && !http.made_folder.empty();
  if (!make) http.made_folder.clear();
  if (make) {
    if (auto problem = prepare(http.made_folder, options.folder)) return *problem;
    std::error_code error;
    const std::string served = whole ? std::string() : fs::canonical(options.folder, error).string();
    http.makers.push_back(thumbnail_maker(options.program, served));
    http.makers.push_back(stream_maker(options.program, served));
    if (options.standard_streams) http.makers.push_back(coarse_maker(options.program, served));
    if (options.standard_streams)
      for (net::Maker& maker : http.makers) maker.wait = kOwnWait;
  }
  const std::string name = fs::canonical(http.folder, folder_error).filename().string();
  if (options.standard_streams)
    http.list = [make](const net::FolderListing& listing, const net::FolderRequest& request) {
      return request.json ? archive_index(listing, request, make) : folder_world(listing, make);
    };
  else
    http.list = [make, name = name.empty() ? std::string("Archive") : name](const net::FolderListing& listing,
                                                                            const net::FolderRequest& request) {
      return archive_index(listing, request, make, name);
    };
  http.missing = [make](const std::string& missing, const net::FolderRequest& request) {
    return scene_link_page(missing, request, make);
  };
  if (const net::CellServerDriver* cells = archive->cells_.get())
    http.more_metrics = [cells] { return cell_metrics(cells->statistics()); };
  if (whole) {
    http.content = options.content;
    http.post = options.post;
  }
  http.report = options.report;
  if (!options.log.empty()) {
    auto log = net::AccessLog::open(options.log);
    if (auto* problem = std::get_if<std::string>(&log)) return *problem;
    http.log = std::move(std::get<net::AccessLog>(log));
  }
  auto started = net::HttpServer::start(std::move(http));
  if (auto* problem = std::get_if<net::HttpServerError>(&started)) return problem->message;
  archive->http_ = std::move(std::get<std::unique_ptr<net::HttpServer>>(started));
  return archive;
}

std::optional<std::uint16_t> Archive::http_port() const { return http_ ? std::optional(http_->port()) : std::nullopt; }

std::optional<std::uint16_t> Archive::cells_port() const {
  return cells_ ? std::optional(cells_->port()) : std::nullopt;
}

void Archive::stop(std::chrono::milliseconds grace) {
  if (http_) http_->stop(grace);
  http_.reset();
  cells_.reset();
}

}  // namespace gs::app
