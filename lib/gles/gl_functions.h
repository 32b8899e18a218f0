/* lib/gles/gl_functions.h: the entry points of OpenGL ES that are used here, found by the caller's get_proc. */
#ifndef PUPIL_GLES_GL_FUNCTIONS_H
#define PUPIL_GLES_GL_FUNCTIONS_H

#define GL_GLES_PROTOTYPES 0 /* nothing is linked */
#include <GLES3/gl31.h>

#include "pupil/gles.h"

/* X(name, type's name) of OpenGL ES 3.0. */
#define GL_FUNCTIONS_30(X)                                                                                             \
    X(ActiveTexture, ACTIVETEXTURE)                                                                                    \
    X(AttachShader, ATTACHSHADER)                                                                                      \
    X(BindBuffer, BINDBUFFER)                                                                                          \
    X(BindBufferBase, BINDBUFFERBASE)                                                                                  \
    X(BindFramebuffer, BINDFRAMEBUFFER)                                                                                \
    X(BindSampler, BINDSAMPLER)                                                                                        \
    X(BindTexture, BINDTEXTURE)                                                                                        \
    X(BindVertexArray, BINDVERTEXARRAY)                                                                                \
    X(BlendEquation, BLENDEQUATION)                                                                                    \
    X(BlendFunc, BLENDFUNC)                                                                                            \
    X(BufferData, BUFFERDATA)                                                                                          \
    X(BufferSubData, BUFFERSUBDATA)                                                                                    \
    X(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS)                                                                  \
    X(Clear, CLEAR)                                                                                                    \
    X(ClearColor, CLEARCOLOR)                                                                                          \
    X(ClientWaitSync, CLIENTWAITSYNC)                                                                                  \
    X(ColorMask, COLORMASK)                                                                                            \
    X(CompileShader, COMPILESHADER)                                                                                    \
    X(CreateProgram, CREATEPROGRAM)                                                                                    \
    X(CreateShader, CREATESHADER)                                                                                      \
    X(DeleteBuffers, DELETEBUFFERS)                                                                                    \
    X(DeleteFramebuffers, DELETEFRAMEBUFFERS)                                                                          \
    X(DeleteProgram, DELETEPROGRAM)                                                                                    \
    X(DeleteSamplers, DELETESAMPLERS)                                                                                  \
    X(DeleteShader, DELETESHADER)                                                                                      \
    X(DeleteSync, DELETESYNC)                                                                                          \
    X(DeleteTextures, DELETETEXTURES)                                                                                  \
    X(DeleteVertexArrays, DELETEVERTEXARRAYS)                                                                          \
    X(Disable, DISABLE)                                                                                                \
    X(DrawArrays, DRAWARRAYS)                                                                                          \
    X(Enable, ENABLE)                                                                                                  \
    X(FenceSync, FENCESYNC)                                                                                            \
    X(Flush, FLUSH)                                                                                                    \
    X(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)                                                                      \
    X(GenBuffers, GENBUFFERS)                                                                                          \
    X(GenFramebuffers, GENFRAMEBUFFERS)                                                                                \
    X(GenSamplers, GENSAMPLERS)                                                                                        \
    X(GenTextures, GENTEXTURES)                                                                                        \
    X(GenVertexArrays, GENVERTEXARRAYS)                                                                                \
    X(GetError, GETERROR)                                                                                              \
    X(GetIntegerv, GETINTEGERV)                                                                                        \
    X(GetProgramInfoLog, GETPROGRAMINFOLOG)                                                                            \
    X(GetProgramiv, GETPROGRAMIV)                                                                                      \
    X(GetShaderInfoLog, GETSHADERINFOLOG)                                                                              \
    X(GetShaderiv, GETSHADERIV)                                                                                        \
    X(GetString, GETSTRING)                                                                                            \
    X(GetStringi, GETSTRINGI)                                                                                          \
    X(GetUniformLocation, GETUNIFORMLOCATION)                                                                          \
    X(LinkProgram, LINKPROGRAM)                                                                                        \
    X(MapBufferRange, MAPBUFFERRANGE)                                                                                  \
    X(PixelStorei, PIXELSTOREI)                                                                                        \
    X(ReadPixels, READPIXELS)                                                                                          \
    X(SamplerParameteri, SAMPLERPARAMETERI)                                                                            \
    X(Scissor, SCISSOR)                                                                                                \
    X(ShaderSource, SHADERSOURCE)                                                                                      \
    X(TexParameteri, TEXPARAMETERI)                                                                                    \
    X(TexStorage2D, TEXSTORAGE2D)                                                                                      \
    X(TexSubImage2D, TEXSUBIMAGE2D)                                                                                    \
    X(Uniform1f, UNIFORM1F)                                                                                            \
    X(Uniform1i, UNIFORM1I)                                                                                            \
    X(Uniform1ui, UNIFORM1UI)                                                                                          \
    X(Uniform2f, UNIFORM2F)                                                                                            \
    X(Uniform2i, UNIFORM2I)                                                                                            \
    X(Uniform2ui, UNIFORM2UI)                                                                                          \
    X(Uniform3f, UNIFORM3F)                                                                                            \
    X(Uniform4f, UNIFORM4F)                                                                                            \
    X(Uniform4fv, UNIFORM4FV)                                                                                          \
    X(Uniform4i, UNIFORM4I)                                                                                            \
    X(Uniform4iv, UNIFORM4IV)                                                                                          \
    X(Uniform4ui, UNIFORM4UI)                                                                                          \
    X(Uniform4uiv, UNIFORM4UIV)                                                                                        \
    X(UniformMatrix3fv, UNIFORMMATRIX3FV)                                                                              \
    X(UnmapBuffer, UNMAPBUFFER)                                                                                        \
    X(UseProgram, USEPROGRAM)                                                                                          \
    X(Viewport, VIEWPORT)

/* And of 3.1. */
#define GL_FUNCTIONS_31(X)                                                                                             \
    X(DispatchCompute, DISPATCHCOMPUTE)                                                                                \
    X(MemoryBarrier, MEMORYBARRIER)

typedef struct gl_functions {
#define GL_FUNCTION_MEMBER(NAME, TYPE) PFNGL##TYPE##PROC NAME;
    GL_FUNCTIONS_30(GL_FUNCTION_MEMBER)
    GL_FUNCTIONS_31(GL_FUNCTION_MEMBER) /* NULL in 3.0 */
    /* NULL where the context has no such thing */
    GLenum(GL_APIENTRY *GetGraphicsResetStatus)(void);
    void *(*GetCurrentContext)(void); /* eglGetCurrentContext */
} gl_functions;

/* The name of the first function that get_proc does not find, or NULL: all of them are there. */
const char *pupil_gl_functions_find(gl_functions *gl, int has_31, pupil_gles_get_proc get_proc);

#endif
