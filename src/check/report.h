/* report.h - what `check` says: closedness, the order and why, how hulls meet.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_REPORT_H
#define MEN_REPORT_H

#include "base/buf.h"
#include "scene/compile.h"

/* Opaque places that a camera sees straight on, through whatever is clear, along n_lines lines that are even over its picture. */
typedef struct ReportView {
    Vec3 *places;
    uint32_t n, n_lines;
} ReportView;

/* Adds warnings that only geometry shows (air gaps, hidden objects, lost lights) to diag. view: as below. */
void report_warnings(const CompiledScene *compiled, const ReportView *view, Diag *diag);
/* Of these, a warning of each light without size that shines through smooth glass that is not flat: there no path finds it. view: NULL, or for
 * those that lose little so, but leave a part of that picture in the dark, too. */
void report_lost_lights(const CompiledScene *compiled, const ReportView *view, Diag *diag);
/* And of each medium in which paths hardly ever end. */
void report_endless(const CompiledScene *compiled, Diag *diag);
/* And remarks on objects in which light is scattered at least so often before it leaves or comes to a camera that is in there. */
void report_many_scatterings(const CompiledScene *compiled, double least, Diag *diag);
/* And of each volume that covers next to nothing of an object whose medium varies by it. */
void report_small_volumes(const CompiledScene *compiled, Diag *diag);
/* And of each light that is wholly inside of an opaque object, or shines into one. */
void report_enclosed_lights(const CompiledScene *compiled, Diag *diag);
/* And remarks on what is so thin, or so far from the origin, that coordinates are coarse for it. */
void report_coarse_places(const CompiledScene *compiled, Diag *diag);
/* And of each mesh of which a part lies within another and faces outward. */
void report_nested_parts(const CompiledScene *compiled, Diag *diag);
/* And of what mesh files say of their materials, which is not taken, where it is of several and all of the mesh of one. */
void report_mesh_materials(const CompiledScene *compiled, Diag *diag);
/* Adds warnings of closed meshes that cross or overlap themselves. Takes about half a second for a million triangles. */
ATTR_NODISCARD Status report_mesh_crossings(const CompiledScene *compiled, Pool *pool, Diag *diag, Error *error);
/* And remarks: what is as likely meant as not, such as sizes that do not go together. Call it after the warnings. */
void report_remarks(const CompiledScene *compiled, Diag *diag);
/* And of these, those on overlapping objects of which only their volumes say which is on top, as no state does. */
void report_order_by_volume(const CompiledScene *compiled, Diag *diag);
/* And the one on a camera, a row of the scene's, that has no object before it. */
void report_empty_view(const CompiledScene *compiled, uint32_t camera, Diag *diag);
/* And the one on a camera that is inside of an opaque object, or a part of whose picture plane is. */
void report_covered_camera(const CompiledScene *compiled, uint32_t camera, Diag *diag);
/* For people: media, hulls from top to bottom, and every pair that meets with the rule that decided. Pairs of
 * many like objects (bubbles) are summed up in one line. */
void report_print(const CompiledScene *compiled, SourceSet *sources, Buf *out);
/* The same facts, every pair by itself, as JSON. */
void report_print_json(const CompiledScene *compiled, SourceSet *sources, Buf *out);

/* A length in a unit that suits people: "0.1 mm". */
void report_add_length(Buf *out, const Scene *scene, double length);

#endif
