function answer = webwrite (url, data, options)
  % What MATLAB's webwrite does with MediaType application/json; Octave's own sends forms alone.
  body = [tempname() ".json"];
  file = fopen (body, "w");
  fputs (file, jsonencode (data));
  fclose (file);
  command = sprintf ("curl -sf -m %d -H 'Content-Type: %s' --data @%s %s", options.Timeout, options.MediaType, body, url);
  [status, text] = system (command);
  delete (body);
  if (status != 0)
    error ("webwrite: curl ended with %d", status);
  end
  answer = jsondecode (text);
end
