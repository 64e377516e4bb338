#pragma once

#include "render/gl/gpu.h"
#include "render/scene/fog.h"

#include <glm/gtc/type_ptr.hpp>
#include <glm/vec4.hpp>

namespace gs::render {

/// Uniform locations of kFogShader in a program.
struct FogUniforms {
  GLint ranges = -1, color = -1, back = -1;

  FogUniforms() = default;
  FogUniforms(const Gl& gl, GLuint program)
      : ranges(gl.GetUniformLocation(program, "fog_ranges")), color(gl.GetUniformLocation(program, "fog_color")),
        back(gl.GetUniformLocation(program, "fog_back")) {}
  /// Sets the uniforms of the current program.
  void set(const Gl& gl, const CameraFog& fog) const {
    const glm::vec4 mixed(fog.color, fog.exponential ? 1 : 0);
    gl.UniformMatrix3fv(ranges, 1, GL_FALSE, glm::value_ptr(fog.ranges_from_camera));
    gl.Uniform4fv(color, 1, glm::value_ptr(mixed));
    gl.Uniform1f(back, fog.back);
  }
};

}  // namespace gs::render
