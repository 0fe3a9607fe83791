/* bare.c - Embree by itself.
 * SPDX-License-Identifier: Apache-2.0 */
#include "bare.h"

RTCScene bare_scene(RTCDevice device, const Vec3f *positions, size_t n_positions, const uint32_t (*triangles)[3],
                    size_t n_triangles)
{
    RTCScene bare = rtcNewScene(device);
    rtcSetSceneFlags(bare, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions, 0, sizeof *positions,
                               n_positions);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles, 0, sizeof *triangles,
                               n_triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(bare, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(bare);
    return bare;
}

RTCScene bare_mesh(RTCDevice device, const Mesh *mesh)
{
    return bare_scene(device, mesh->positions, mesh->n_vertices, (const uint32_t(*)[3])mesh->triangles,
                      mesh->n_triangles);
}
