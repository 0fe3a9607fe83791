/* import.h - from what a mesh file says to the text of a scene, for a person to go on with.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_IMPORT_H
#define MEN_IMPORT_H

#include "base/buf.h"
#include "mesh/mesh_file.h"

typedef enum ImportFloor { FLOOR_AUTO, FLOOR_ON, FLOOR_OFF } ImportFloor;

typedef struct ImportOptions {
    const char *path; /* of the mesh file, for people */
    const char *file; /* the same as the scene names it */
    const char
        *folder; /* what stands before names of pictures beside the mesh file, as the scene names them: "", "models/" */
    const char *real_folder; /* the same from the working folder, to look whether they are there */
    const char *stem;        /* what pictures of the scene, and within the mesh file, are called after */
    double unit_m;           /* of the mesh file; 0: as its format says, else as is likely */
    bool up_z;               /* its z axis points up */
    ImportFloor
        floor; /* auto: with lights of the studio, or below what is all clear, unless something lies below all else */
} ImportOptions;

/* A picture within the mesh file, and the name that the scene has for it. The bytes are the source's. */
typedef struct ImportPicture {
    char *name;
    const char *bytes;
    size_t length;
} ImportPicture;

typedef struct Import {
    Buf text; /* not laid out yet */
    ImportPicture *pictures;
    size_t n_pictures, picture_capacity;
    char **notes; /* what could not be taken, and what was assumed: lines for people */
    size_t n_notes, note_capacity;
    size_t n_objects, n_media, n_surfaces, n_cameras, n_lights;
} Import;

/* The source must have been read as a whole, with the mesh, which stays as it is. import_clear is due in every case. */
ATTR_NODISCARD Status import_scene(const ImportOptions *options, const MeshSource *source, const Mesh *mesh,
                                   Import *out, Error *error);
void import_clear(Import *import);

#endif
