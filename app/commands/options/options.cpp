#include "app/commands/options/options.h"
#include "app/commands/check.h"
#include "app/commands/nodes.h"
#include "app/commands/open.h"
#include "app/commands/options/encode_options.h"
#include "app/commands/options/option_values.h"
#include "app/commands/options/picture_options.h"
#include "app/commands/options/setters.h"
#include "app/commands/options/splat_options.h"
#include "app/commands/serve.h"
#include "app/commands/trace.h"
#include "base/text.h"
#include "net/base/host_names.h"
#include "net/ssh/ssh_target.h"
#include "render/gl/context.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

Problem set_size(SizeOptions& options, const std::string& value) {
  options.paper = read_paper(value);
  if (options.paper) return {};
  double size[2];
  if (!read_list(value, 'x', size) || size[0] < 1 || size[1] < 1 || size[0] > kMaxPictureSide ||
      size[1] > kMaxPictureSide)
    return "expected WIDTHxHEIGHT in pixels, each from 1 to 65536, or with mm, cm or in: 210x297mm";
  options.size_given = true;
  options.width = static_cast<int>(size[0]);
  options.height = static_cast<int>(size[1]);
  return {};
}

// Sets the image file. The name needs no extension, because desktops request thumbnails without one.
Problem set_snapshot(OpenCommand& options, const std::string& value) {
  options.snapshot = value;
  const std::string extension = lower_case(std::filesystem::path(value).extension().string());
  if (value.empty()) return "expected a file";
  return extension.empty() || extension == ".png" ? Problem{}
                                                  : "expected a name that ends in .png, because pictures are PNG files";
}

Problem set_samples(PictureOptions& options, const std::string& value) {
  return read(value, options.samples) && options.samples >= 1 && options.samples <= 64 ? Problem{} : "expected 1 to 64";
}

Problem set_orbit(PictureOptions& options, const std::string& value) {
  double angles[2];
  if (!read_list(value, ',', angles)) return "expected AZIMUTH,ELEVATION in degrees";
  options.orbit = {angles[0], angles[1]};
  return {};
}

Problem set_layout(OpenCommand& options, const std::string& value) {
  auto read = read_split(value);
  if (auto* problem = std::get_if<std::string>(&read)) return "expected a split such as '1:2|(2/3)': " + *problem;
  options.layout = std::move(std::get<SplitTree>(read));
  return {};
}

Problem set_max_bytes(LoadingOptions& options, const std::string& value) {
  options.max_bytes_given = true;
  return read_bytes(value, options.max_bytes) ? Problem{} : std::string(kExpectedBytes);
}

Problem set_backend(PictureOptions& options, const std::string& value) {
  const auto known = render::headless_backends();
  if (value != "auto" && value != "glfw" && std::find(known.begin(), known.end(), value) == known.end()) {
    std::string names = "expected auto, glfw";
    for (const std::string_view name : known) names += ", " + std::string(name);
    return names;
  }
  options.backend = value;
  return {};
}

Problem set_headlight(PictureOptions& options, const std::string& value) {
  if (value != "on" && value != "off") return "expected on or off";
  options.headlight = value == "on";
  return {};
}

// Parses simulated seconds. The maximum is one day, which is over five million steps.
Problem set_seconds(double& seconds, const std::string& value) {
  constexpr double kLongest = 86400;
  return read(value, seconds) && seconds >= 0 && seconds <= kLongest ? Problem{} : "expected seconds, from 0 to 86400";
}

// Sets the simulated time of pictures, and the step of a time series.
Problem set_time(CommandOptions& options, const std::string& value) {
  const auto step = read_shown_step(value);
  auto* const open = dynamic_cast<OpenCommand*>(&options);
  if (!step) return open ? "expected seconds, from 0 to 86400" : "expected the number of a step, or a time such as 2.5";
  VoxelComponent& read = dynamic_cast<LoadOptions&>(options).component;
  read.step = *step;
  if (auto* picture = dynamic_cast<PictureOptions*>(&options)) picture->volume.component = read;
  return open ? set_seconds(open->time, value) : Problem{};
}

Problem set_until(TraceCommand& options, const std::string& value) {
  return set_seconds(options.until.emplace(), value);
}

Problem set_splats(PictureOptions& options, const std::string& value) {
  options.splats = value == "gl"    ? render::SplatPath::gl
                   : value == "cpu" ? render::SplatPath::cpu
                                    : render::SplatPath::automatic;
  return value == "auto" || value == "gl" || value == "cpu" ? Problem{} : "expected auto, gl or cpu";
}

Problem set_budget(PictureOptions& options, const std::string& value) {
  return read_count(value, options.budget) && options.budget > 0 ? Problem{} : "expected a number of vectors above 0";
}

Problem set_loss(LoadOptions& options, const std::string& value) {
  const std::size_t colon = value.find(':');
  const bool good = read_share(std::string_view(value).substr(0, colon), options.loss) &&
                    (colon == std::string::npos || read(std::string_view(value).substr(colon + 1), options.loss_seed));
  return good ? Problem{} : "expected a share from 0 to 1 or a percentage such as 30%, optionally followed by :SEED";
}

Problem set_allowed(LoadOptions& options, const std::string& value) {
  std::error_code error;
  if (!std::filesystem::exists(value, error)) return "expected an existing folder";
  options.allowed.push_back(value);
  return {};
}

Problem set_remote_program(LoadOptions& options, const std::string& value) {
  options.remote_program = value;
  return net::refuse_remote_program(value);
}

Problem set_timeout(LoadingOptions& options, const std::string& value) {
  options.timeout_given = true;
  return read(value, options.timeout_seconds) && options.timeout_seconds > 0 ? Problem{} : "expected seconds above 0";
}

Problem set_memory(LoadOptions& options, const std::string& value) {
  constexpr std::uint64_t kMin = std::uint64_t{16} << 20, kMax = std::uint64_t{1} << 46;
  std::uint64_t bytes = 0;
  if (!read_bytes(value, bytes) || bytes > kMax || bytes < kMin)
    return "expected a number of bytes, optionally with K, M or G, of at least 16M";
  options.limits.memory = bytes;
  return {};
}

Problem set_port(std::optional<std::uint16_t>& port, const std::string& value) {
  std::uint16_t number = 0;
  if (!read(value, number)) return "expected a port from 0 to 65535; 0 is any free port";
  port = number;
  return {};
}

Problem set_control(OpenCommand& options, const std::string& value) {
  std::optional<std::uint16_t> port;
  if (value.find_first_not_of("0123456789") == std::string::npos) {
    const Problem problem = set_port(port, value);
    if (!problem) options.control.ports.push_back(*port);
    return problem;
  }
  options.control.paths.push_back(value);
  return {};
}

Problem set_confine(LoadingOptions& options, const std::string& value) {
  options.confine = value;
  options.offline = true;
  return value.empty() ? Problem("expected a folder") : Problem{};
}

// Sets the rate in bits per second: of sending for `serve`, else of reading from servers.
Problem set_rate(CommandOptions& options, const std::string& value) {
  auto* served = dynamic_cast<ArchiveOptions*>(&options);
  std::uint64_t& rate = served ? served->rate : dynamic_cast<LoadOptions&>(options).rate;
  return read_count(value, rate) && rate > 0
             ? Problem{}
             : "expected bits per second above 0, such as 200k (k, M and G are allowed)";
}

Problem set_control_token(OpenCommand& options, const std::string& value) {
  options.control.token_file = value;
  return value.empty() ? Problem("expected a file") : Problem{};
}

Problem set_congestion(ArchiveOptions& options, const std::string& value) {
  std::string names;
  for (const net::CongestionName& row : net::congestion_names()) {
    if (row.name == value) {
      options.congestion = row.response;
      return {};
    }
    names += (names.empty() ? "expected " : ", ") + std::string(row.name);
  }
  return names;
}

Problem set_host_names(ArchiveOptions& options, const std::string& value) {
  const bool good = each_of(value, [&](const std::string& name) {
    options.host_names.push_back(name);
    return net::host_of(name) || net::ip_address_of(name);
  });
  return good ? Problem{} : "expected host names separated by commas";
}

Problem set_origins(ArchiveOptions& options, const std::string& value) {
  options.origins.emplace();
  const bool good = each_of(value, [&](const std::string& origin) {
    options.origins->push_back(origin);
    if (origin == "*") return true;
    const std::size_t host = origin.find("://");
    return host != std::string::npos && host > 0 && net::host_of(std::string_view(origin).substr(host + 3)).has_value();
  });
  return good ? Problem{} : "expected * or origins such as https://example.org, separated by commas";
}

Problem set_proxies(ArchiveOptions& options, const std::string& value) {
  const bool good = each_of(value, [&](const std::string& text) {
    const auto block = net::address_block_of(text);
    if (block) options.proxies.push_back(*block);
    return block.has_value();
  });
  return good ? Problem{} : "expected addresses or blocks such as 10.0.0.0/8, separated by commas";
}

Problem set_connections(ArchiveOptions& options, const std::string& value) {
  constexpr std::size_t kMax = 1'000'000;
  if (read(value, options.connections) && options.connections > 0 && options.connections <= kMax) return {};
  return "expected a number from 1 to 1,000,000";
}

Problem set_max_age(ArchiveOptions& options, const std::string& value) {
  constexpr std::int64_t kMax = 315'360'000;
  if (read(value, options.max_age) && options.max_age >= 0 && options.max_age <= kMax) return {};
  return "expected seconds from 0 to 315,360,000 (ten years)";
}

constexpr OptionRow kOptions[] = {
    {"--snapshot", "OUT.png", "", "write a picture without opening a window, and exit", "open ", with<set_snapshot>},
    {"--size", "WxH", "1024x768", "size of the window or picture in pixels; pictures also in mm, cm or in: 210x297mm",
     "open animate trace ", with<set_size>},
    {"--time", "SECONDS|N", "0",
     "draw the picture after this simulated time, in steps of at most 1/60 s. The simulated clock starts at 946684800, "
     "which is 2000-01-01T00:00:00Z. For a time series of volumes, read the step with this number, from 0. With a "
     "decimal point, read the step with the nearest time",
     "open animate encode export info ", with<set_time>},
    {"--until", "SECONDS", "", "end after this simulated time", "trace ", with<set_until>},
    {"--sound", "FILE.wav", "", "write the sound of the simulated time, at most one hour", "open trace ",
     text<&SimulationOptions::sound>},
    {"--mute", "", "", "start without sound; M turns it on", "open ", flag<&OpenCommand::muted>},
    {"--reuse", "", "", "open the files in the existing window, if there is one", "open ", flag<&OpenCommand::reuse>},
    {"--config", "FILE", "", "use FILE as settings file instead of ~/.config/ghostspace/settings.conf", "open ",
     file<&OpenCommand::config>},
    {"--no-config", "", "",
     "read and write no user data: settings, bookmarks, recent files or log. Always on for pictures and controlled "
     "programs",
     "open ", flag<&OpenCommand::no_config>},
    {"--input", "FILE", "",
     "apply user input from JSON lines in the order of time. {\"t\":3,\"viewpoint\":\"NAME\"} binds a Viewpoint. "
     "{\"t\":4,\"set\":\"DEF.eventIn\",\"value\":\"1 0 0\"} sends an event. {\"t\":5,\"move\":[X,Y]}, or press or "
     "release instead of move, uses the left button at a pixel of --size, from the upper left corner. "
     "{\"t\":6,\"press\":\"NAME\"} presses a sensor by DEF name or Type#number, {\"t\":7,\"drag\":[X,Y]} drags it by "
     "pixels, {\"t\":8,\"release\":true} releases it. {\"t\":9,\"viewer\":[X,Y,Z]} moves the viewer",
     "open trace ", text<&SimulationOptions::input>},
    {"--press-sensors", "", "",
     "press, drag and release every pointing-device sensor and Anchor, even if hidden, and visit every "
     "ProximitySensor. The last line reports their number",
     "open trace ", flag<&SimulationOptions::press_sensors>},
    {"--control", "PATH|PORT", "",
     "accept control by local programs with a token: JSON-RPC over a Unix socket at PATH, or over WebSockets on PORT "
     "of 127.0.0.1 (0 is any free port). May be repeated. With --backend osmesa or egl there is no window, and the "
     "program runs until a client ends it",
     "open ", with<set_control>, true},
    {"--control-token", "FILE", "",
     "write the token for --control to FILE, readable by its owner only, instead of standard error", "open ",
     with<set_control_token>},
    {"--samples", "N", "4", "anti-aliasing samples per pixel", "open animate ", with<set_samples>},
    {"--viewpoint", "NAME|N", "", "start at the Viewpoint with this description, DEF name or number (from 1)",
     "open animate ", text<&PictureOptions::viewpoint>},
    {"--layout", "SPLIT", "",
     "arrange the viewports, numbered from 1 like the files. '|' places them side by side, '/' above each other, "
     "brackets group them, and ':N' makes one N times as large: '1:2|(2/3)'",
     "open ", with<set_layout>},
    {"--orbit", "AZ,EL", "",
     "frame the whole scene from this azimuth and elevation in degrees; 0,0 is the view from +Z", "open animate ",
     with<set_orbit>},
    {"--headlight", "on|off", "", "override the headlight of the world", "open animate ", with<set_headlight>},
    {"--backend", "auto|glfw|egl|osmesa", "auto", "select the drawing backend", "open animate ", with<set_backend>},
    {"--splats", "auto|gl|cpu", "auto", "select the splat renderer", "open animate ", with<set_splats>},
    {"--budget", "VECTORS", "", "limit the vectors drawn in a viewport", "open animate ", with<set_budget>},
    {"--loss", "P[:SEED]", "", "drop this share of the packets of a stream (0 to 1, or 30%)", "open fetch ",
     with<set_loss>},
    {"--max-bytes", "SIZE", "",
     "read only this number of bytes of the file; encode: limit the size of the output. Bytes, optionally with K, M or "
     "G: 400k",
     "open check info encode fetch trace ", with<set_max_bytes>},
};

constexpr OptionRow kOtherOptions[] = {
    {"--json", "", "", "machine-readable", "info encode fetch ", flag<&ReportOptions::json>},
    {"--timeout", "SECONDS", "30",
     "limit loading and leave out the rest. Drawing a snapshot may take as long again. By default, a window waits "
     "without limit",
     "open animate check print info encode export fetch trace ", with<set_timeout>},
    {"--memory", "SIZE", "2G",
     "limit the memory of one world (bytes, optionally with K, M or G). The excess is left out, and a message names "
     "the limit",
     "open animate check print info encode export fetch trace ", with<set_memory>},
    {"--offline", "", "", "disable the network", "open animate check print info encode export trace ",
     flag<&LoadOptions::offline>},
    {"--follow", "", "",
     "reload files when a program writes to them, and show the newest step: a growing file, new files of a series, "
     "a "
     "growing Zarr array; also for http:, https: and ssh: URLs",
     "open ", flag<&LoadOptions::follow>},
    {"--remote-command", "COMMAND", "ghostspace",
     "program for ssh: URLs, as for a shell on the remote machine; it may begin with another program: \"srun -N1 "
     "ghostspace\"",
     "open animate check print info encode export fetch trace ", with<set_remote_program>},
    {"--allow-network", "", "", "allow network access, without a question, to Scripts that have read other local files",
     "open animate trace ", flag<&LoadOptions::allow_network>},
    {"--allow", "FOLDER", "", "let a local world also read this folder and its subfolders; may be repeated",
     "open animate check print info encode export fetch trace ", with<set_allowed>, true},
    {"--confine", "FOLDER", "",
     "restrict the process, for untrusted files: it reads only FOLDER and the system libraries, writes only to the "
     "folder of OUT and opens no connection. Needs Landlock and seccomp in the kernel",
     "open check print info encode export trace ", with<set_confine>},
    {"--http", "PORT", "8080", "serve HTTP on this port; 0 is any free port. Off if only --cells is given", "serve ",
     with<[](ArchiveOptions& o, const std::string& v) { return set_port(o.http_port, v); }>},
    {"--cells", "PORT", "", "serve streams as ATM cells over UDP on this port", "serve ",
     with<[](ArchiveOptions& o, const std::string& v) { return set_port(o.cells_port, v); }>},
    {"--stdio", "", "",
     "serve over standard input and output instead of ports, for ssh: URLs. Without FOLDER, serve all files of this "
     "account",
     "serve ", flag<&ArchiveOptions::standard_streams>},
    {"--bind", "ADDRESS|*", "127.0.0.1", "listen at this address; * is all", "serve ", text<&ArchiveOptions::bind>},
    {"--host", "NAME,...", "",
     "further names of the server besides localhost and its address. A local server rejects all other names, against "
     "DNS rebinding",
     "serve ", with<set_host_names>},
    {"--cors", "ORIGIN,...|*", "none; all with --bind", "sites with access from their web pages", "serve ",
     with<set_origins>},
    {"--proxies", "ADDRESS,...", "",
     "trusted proxies, as addresses or blocks (10.0.0.0/8). Per-client limits apply to the client in their "
     "X-Forwarded-For",
     "serve ", with<set_proxies>},
    {"--connections", "N", "4096", "limit the HTTP connections of all clients together", "serve ",
     with<set_connections>},
    {"--max-age", "SECONDS", "0",
     "let clients and CDNs use files for this time without asking again; from a year (31536000) on, also marked as "
     "immutable. For files that never change under one name",
     "serve ", with<set_max_age>},
    {"--rate", "BIT/S", "",
     "serve: limit the traffic of all clients together; otherwise: request this rate from cell servers and limit other "
     "servers to it. In a window the limit applies to each viewport and can be changed there",
     "serve open fetch ", set_rate},
    {"--congestion", "NAME", "equation",
     "response of cells to losses: equation (like TCP), delay-aware (ignores losses without a queue, for lossy links) "
     "or reserved (ignores all losses, for paths with a reserved rate)",
     "serve ", with<set_congestion>},
    {"--cache", "FOLDER", "", "keep thumbnails and encoded streams in this folder", "serve ",
     text<&ArchiveOptions::cache>},
    {"--log", "FILE", "-", "write the access log to FILE; - is standard output", "serve ", text<&ArchiveOptions::log>},
    {"--scripts", "", "", "also compile the programs of Scripts", "check ", flag<&CheckCommand::scripts>},
    {"--stats", "FILE.json", "",
     "write measurements of the run: seconds per phase, bytes, triangles, memory; - is standard output", "open check ",
     text<&ReportOptions::stats>},
    {"--markdown", "", "", "print Markdown tables", "nodes ", flag<&NodesCommand::markdown>},
    {"--wrl", "", "", "print PROTO declarations (the default)", "nodes ",
     [](CommandOptions&, const std::string&) { return Problem{}; }},
};

}  // namespace

bool accepts(const CommandRow& command, const OptionRow& option) {
  return option.commands.find(std::string(command.name) + ' ') != std::string_view::npos;
}

std::span<const OptionRow> option_rows() {
  static const std::vector<OptionRow> all = [] {
    std::vector<OptionRow> rows;
    for (const std::span<const OptionRow> part :
         {std::span<const OptionRow>(kOptions), encode_option_rows(), splat_option_rows(),
          std::span<const OptionRow>(kOtherOptions), picture_option_rows()})
      rows.insert(rows.end(), part.begin(), part.end());
    return rows;
  }();
  return all;
}

}  // namespace gs::app
