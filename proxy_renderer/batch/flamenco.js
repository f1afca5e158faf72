// SPDX-License-Identifier: Apache-2.0
// A Flamenco job type: puts a look of Vibe Render on a .blend, then renders a range of its frames.
// `vibe flamenco install` copies it into the folder "scripts" of a Flamenco Manager.

const JOB_TYPE = {
    label: "Vibe Render",
    description: "Give a .blend the look of a preset, then render its frames",
    settings: [
        { key: "preset", type: "string", subtype: "file_path", required: true,
          description: "The preset.json that `vibe run` or `vibe batch` has written, on shared storage" },
        { key: "frames", type: "string", required: true,
          eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
          evalInfo: { showLinkButton: true, description: "Scene frame range" },
          description: "Frame range to render. Examples: '47', '1-30', '3, 5-10, 47-327'" },
        { key: "chunk_size", type: "int32", default: 1, visible: "submission",
          description: "Number of frames in one render task" },
        { key: "output_root", type: "string", subtype: "dir_path", required: true, visible: "submission",
          description: "Folder on shared storage for the vibed .blend and the frames" },
        { key: "output_path", type: "string", subtype: "dir_path", editable: false,
          eval: "str(Path(abspath(settings.output_root), jobname, '{timestamp}'))",
          description: "Where the files of this job go" },
        { key: "vibe_script", type: "string", subtype: "file_path", required: true, default: "{{script}}", visible: "submission",
          description: "batch.py of the add-on, where all workers find it" },
        { key: "blendfile", type: "string", required: true, visible: "web",
          description: "Path of the .blend" },
        { key: "format", type: "string", required: true, visible: "web",
          eval: "C.scene.render.image_settings.file_format" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const folder = settings.output_path.replace("{timestamp}", formatTimestampLocal(job.created));
    settings.output_path = folder; // whoever looks at the job later sees where its files are
    const look = author.Task("apply-look", "blender");
    look.addCommand(blender(settings.blendfile, [
        "--python-exit-code", "1", "--python", settings.vibe_script,
        "--", "--apply", settings.preset, "--out", folder, "--size=256", "--samples=16",
    ]));
    job.addTask(look);
    const chunks = frameChunker(settings.frames, settings.chunk_size);
    for (const chunk of chunks) {
        const task = author.Task("render-" + chunk, "blender");
        task.addCommand(blender(path.join(folder, "vibed.blend"), [
            "--render-output", path.join(folder, "frames", "######"),
            "--render-format", settings.format,
            "--render-frame", chunk.replace(/-/g, ".."),
        ]));
        task.addDependency(look);
        job.addTask(task);
    }
}

function blender(file, args) {
    return author.Command("blender-render", {
        exe: "{blender}", exeArgs: "{blenderArgs}", argsBefore: [], blendfile: file, args: args,
    });
}
