#include "vrml/nodes/x3d/components.h"

// Rows of the X3D component Sound (audio graph) (ISO/IEC 19775-1).
namespace gs::vrml {
namespace {

constexpr X3DRow kSoundProcessingX3DRows[] = {
    {"Analyser",
     "Sound",
     2,
     "children",
     "X3DSoundProcessingNode",
     Role::child | Role::time_dependent,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFInt32    fftSize 2048  # [0,inf)
  exposedField SFInt32    frequencyBinCount 1024  # [0,inf)
  exposedField SFFloat    gain 1
  exposedField SFFloat    maxDecibels -30
  exposedField SFFloat    minDecibels -100
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFFloat    smoothingTimeConstant 0.8  # [0,inf)
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFTime     tailTime 0  # [0,inf)
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"AudioDestination",
     "Sound",
     2,
     "children",
     "X3DSoundDestinationNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFInt32    maxChannelCount 2  # [0,inf)
  exposedField SFString   mediaDeviceID ""
  eventOut     SFInt32    channelCount
  eventOut     SFBool     isActive
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"BiquadFilter",
     "Sound",
     2,
     "children",
     "X3DSoundProcessingNode",
     Role::child | Role::time_dependent,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFFloat    detune 0  # [0,inf)
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    frequency 350  # [0,inf)
  exposedField SFFloat    gain 1
  exposedField SFTime     pauseTime 0
  exposedField SFFloat    qualityFactor 1  # [0,inf)
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFTime     tailTime 0  # [0,inf)
  exposedField SFString   type "LOWPASS"
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"BufferAudioSource",
     "Sound",
     2,
     "children",
     "X3DSoundSourceNode X3DUrlObject",
     Role::child | Role::time_dependent | Role::sound_source,
     NodeKind::other,
     R"(
  exposedField SFTime     autoRefresh 0  # [0,inf)
  exposedField SFTime     autoRefreshTimeLimit 3600  # [0,inf)
  exposedField MFFloat    buffer []  # [-1,1]
  exposedField SFTime     bufferDuration 0  # [0,inf)
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField SFString   description ""
  exposedField SFFloat    detune 0  # [0,inf)
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFBool     load TRUE
  exposedField SFBool     loop FALSE
  exposedField SFFloat    loopEnd 0  # [0,inf)
  exposedField SFFloat    loopStart 0  # [0,inf)
  exposedField SFInt32    numberOfChannels 0  # [0,inf)
  exposedField SFTime     pauseTime 0
  exposedField SFFloat    playbackRate 1
  exposedField SFTime     resumeTime 0
  exposedField SFFloat    sampleRate 0  # [0,inf)
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField MFString   url []
  eventOut     SFInt32    bufferlength
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
  eventOut     SFInt32    length  # [0,inf)
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"ChannelMerger",
     "Sound",
     2,
     "children",
     "X3DSoundChannelNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  eventOut     SFInt32    channelCount
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"ChannelSelector",
     "Sound",
     2,
     "children",
     "X3DSoundChannelNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField SFInt32    channelSelection 0  # [0,inf)
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  eventOut     SFInt32    channelCount
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"ChannelSplitter",
     "Sound",
     2,
     "children",
     "X3DSoundChannelNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField MFNode     outputs []  # X3DSoundChannelNode,X3DSoundProcessingNode,X3DSoundSourceNode
  eventOut     SFInt32    channelCount
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Convolver",
     "Sound",
     2,
     "children",
     "X3DSoundProcessingNode",
     Role::child | Role::time_dependent,
     NodeKind::other,
     R"(
  exposedField MFFloat    buffer []  # [-1,1]
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFBool     normalize FALSE
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFTime     tailTime 0  # [0,inf)
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Delay",
     "Sound",
     2,
     "children",
     "X3DSoundProcessingNode",
     Role::child | Role::time_dependent,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFTime     delayTime 0  # [0,inf)
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFTime     maxDelayTime 1  # [0,inf)
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFTime     tailTime 0  # [0,inf)
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"DynamicsCompressor",
     "Sound",
     2,
     "children",
     "X3DSoundProcessingNode",
     Role::child | Role::time_dependent,
     NodeKind::other,
     R"(
  exposedField SFTime     attack 0.003  # [0,inf)
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFFloat    knee 30  # [0,inf)
  exposedField SFTime     pauseTime 0
  exposedField SFFloat    ratio 12  # [1,20]
  exposedField SFTime     release 0.25  # [0,inf)
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFTime     tailTime 0  # [0,inf)
  exposedField SFFloat    threshold -24  # [-100,0]
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
  eventOut     SFFloat    reduction  # (-inf,0]
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"Gain",
     "Sound",
     2,
     "children",
     "X3DSoundProcessingNode",
     Role::child | Role::time_dependent,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFTime     tailTime 0  # [0,inf)
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"MicrophoneSource",
     "Sound",
     2,
     "children",
     "X3DSoundSourceNode",
     Role::child | Role::time_dependent | Role::sound_source,
     NodeKind::other,
     R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFString   mediaDeviceID ""
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"OscillatorSource",
     "Sound",
     2,
     "children",
     "X3DSoundSourceNode",
     Role::child | Role::time_dependent | Role::sound_source,
     NodeKind::other,
     R"(
  exposedField SFString   description ""
  exposedField SFFloat    detune 0  # [0,inf)
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    frequency 440  # [0,inf)
  exposedField SFFloat    gain 1
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"PeriodicWave",
     "Sound",
     2,
     "periodicWave",
     "X3DSoundNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField MFFloat    optionsImag []
  exposedField MFFloat    optionsReal []
  exposedField SFString   type "SQUARE"
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"StreamAudioDestination",
     "Sound",
     2,
     "children",
     "X3DSoundDestinationNode",
     Role::child,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFString   mediaDeviceID ""
  exposedField SFString   streamIdentifier ""
  eventOut     SFInt32    channelCount
  eventOut     SFBool     isActive
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"StreamAudioSource",
     "Sound",
     2,
     "children",
     "X3DSoundSourceNode",
     Role::child | Role::time_dependent | Role::sound_source,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFString   streamIdentifier ""
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
    {"WaveShaper",
     "Sound",
     2,
     "children",
     "X3DSoundProcessingNode",
     Role::child | Role::time_dependent,
     NodeKind::other,
     R"(
  exposedField SFString   channelCountMode "MAX"
  exposedField SFString   channelInterpretation "SPEAKERS"
  exposedField MFNode     children []  # Analyser,AudioClip,AudioDestination,BiquadFilter,BufferAudioSource,ChannelMerger,ChannelSelector,ChannelSplitter,Convolver,Delay,DynamicsCompressor,Gain,ListenerPointSource,MicrophoneSource,MovieTexture,OscillatorSource,Sound,SpatialSound,StreamAudioDestination,StreamAudioSource,WaveShaper
  exposedField SFString   description ""
  exposedField SFBool     enabled TRUE
  exposedField SFFloat    gain 1
  exposedField SFString   oversample "NONE"
  exposedField SFTime     pauseTime 0
  exposedField SFTime     resumeTime 0
  exposedField SFTime     startTime 0
  exposedField SFTime     stopTime 0
  exposedField SFTime     tailTime 0  # [0,inf)
  eventOut     SFInt32    channelCount
  eventOut     SFTime     elapsedTime  # [0,inf)
  eventOut     SFBool     isActive
  eventOut     SFBool     isPaused
)",
     {},
     nullptr,
     UrlContent::none,
     true},
};

}  // namespace

std::span<const X3DRow> x3d_sound_processing_rows() { return kSoundProcessingX3DRows; }

}  // namespace gs::vrml
