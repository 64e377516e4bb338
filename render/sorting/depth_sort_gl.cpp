#include "render/sorting/depth_sort_gl.h"

#include "render/sorting/depth_sort_shaders.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kSortBlock = 4096, kMaxGroups = 65535;  // maximum groups that OpenGL 4.3 guarantees
constexpr unsigned kShaderDigitBits = 4, kShaderDigits = 1u << kShaderDigitBits, kShaderPasses = 32 / kShaderDigitBits;
static_assert(kShaderPasses % 2 == 0);  // with an even number of passes, the result is in the original buffer

}  // namespace

Program compute_program(const Gl& gl, const std::string& source) {
  const GpuHandle<GpuObject::shader> shader(gl, gl.CreateShader(GL_COMPUTE_SHADER));
  const GLchar* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  gl.ShaderSource(shader.name(), 1, &text, &length);
  gl.CompileShader(shader.name());
  GLint good = GL_FALSE;
  gl.GetShaderiv(shader.name(), GL_COMPILE_STATUS, &good);
  if (!good) return {};
  Program program(gl, gl.CreateProgram());
  gl.AttachShader(program.name(), shader.name());
  gl.LinkProgram(program.name());
  gl.GetProgramiv(program.name(), GL_LINK_STATUS, &good);
  return good ? std::move(program) : Program();
}

std::unique_ptr<DepthGlSort> DepthGlSort::create(const Gl& gl, const std::string& keys) {
  if (!gl.DispatchCompute) return nullptr;
  std::unique_ptr<DepthGlSort> sort(new DepthGlSort(gl));
  const std::string start = std::string("#version 430 core\n") + kSortShader;
  take_errors(gl);
  sort->keys_ = compute_program(gl, start + kSortKeysShader + keys);
  sort->count_ = compute_program(gl, start + kSortCountShader);
  sort->scan_ = compute_program(gl, start + kSortScanShader);
  sort->scatter_ = compute_program(gl, start + kSortScatterShader);
  take_errors(gl);
  for (const Program* program : {&sort->keys_, &sort->count_, &sort->scan_, &sort->scatter_})
    if (!*program) return nullptr;
  return sort;
}

bool DepthGlSort::fill(const Buffer& buffer, std::size_t bytes) const {
  gl_.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffer.name());
  gl_.BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_COPY);
  return gl_.GetError() == GL_NO_ERROR;
}

bool DepthGlSort::make_room(std::size_t total) {
  if (total <= room_) return true;
  room_ = 0;
  const std::size_t entries = total + total / 4;
  for (Buffer* buffer : {&sorted_keys_, &unsorted_keys_, &values_}) {
    *buffer = make_buffer(gl_);
    if (!fill(*buffer, entries * sizeof(std::uint32_t))) return false;
  }
  counts_ = make_buffer(gl_);
  if (!fill(counts_, (entries / kSortBlock + 1) * kShaderDigits * sizeof(std::uint32_t))) return false;
  room_ = entries;
  return true;
}

bool DepthGlSort::sort(const Data& data, std::size_t total, const Buffer& order) {
  const std::size_t groups = (total + kSortBlock - 1) / kSortBlock;
  if (total == 0 || groups > kMaxGroups) return false;
  take_errors(gl_);
  if (!make_room(total) || !fill(order, total * sizeof(std::uint32_t))) return false;
  const auto use = [&](const Program& program) {
    gl_.UseProgram(program.name());
    gl_.Uniform1i(gl_.GetUniformLocation(program.name(), "total"), static_cast<GLint>(total));
    gl_.Uniform1i(gl_.GetUniformLocation(program.name(), "groups"), static_cast<GLint>(groups));
  };
  const auto bind = [&](const std::array<GLuint, 5>& buffers) {
    for (GLuint i = 0; i < buffers.size(); ++i) gl_.BindBufferBase(GL_SHADER_STORAGE_BUFFER, i + 1, buffers[i]);
  };
  const auto run = [&](std::size_t count, GLbitfield until = GL_SHADER_STORAGE_BARRIER_BIT) {
    gl_.DispatchCompute(static_cast<GLuint>(count), 1, 1);
    gl_.MemoryBarrier(until);
  };
  use(keys_);
  gl_.Uniform1i(gl_.GetUniformLocation(keys_.name(), "codes"), 0);
  gl_.Uniform1i(gl_.GetUniformLocation(keys_.name(), "items"), 1);
  gl_.Uniform1i(gl_.GetUniformLocation(keys_.name(), "item_count"), data.item_count);
  for (GLuint unit = 0; unit < 2; ++unit) {
    gl_.ActiveTexture(GL_TEXTURE0 + unit);
    gl_.BindTexture(GL_TEXTURE_BUFFER, unit == 0 ? data.codes : data.items);
  }
  gl_.ActiveTexture(GL_TEXTURE0);
  std::array<GLuint, 5> now{unsorted_keys_.name(), order.name(), sorted_keys_.name(), values_.name(), counts_.name()};
  bind(now);
  run(groups);
  for (unsigned pass = 0; pass < kShaderPasses; ++pass) {
    const auto shift = static_cast<GLint>(pass * kShaderDigitBits);
    bind(now);
    use(count_);
    gl_.Uniform1i(gl_.GetUniformLocation(count_.name(), "shift"), shift);
    run(groups);
    use(scan_);
    run(1);
    use(scatter_);
    gl_.Uniform1i(gl_.GetUniformLocation(scatter_.name(), "shift"), shift);
    run(groups,
        GL_SHADER_STORAGE_BARRIER_BIT |
            (pass + 1 == kShaderPasses ? GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT : 0u));
    std::swap(now[0], now[2]);
    std::swap(now[1], now[3]);
  }
  bind({});
  return gl_.GetError() == GL_NO_ERROR;
}

}  // namespace gs::render
